#include "train/formats/quaternion.h"

#include <cmath>

#include "runtime/error.h"

namespace vkopple {
namespace {

using Vector3 = std::array<double, 3>;

Vector3 column(const Matrix3& m, std::size_t i) { return {m[i], m[3 + i], m[6 + i]}; }
Vector3 operator-(const Vector3& v) { return {-v[0], -v[1], -v[2]}; }
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

double determinant(const Matrix3& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
         m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/// Where the camera's right, forward and up point in the world.
struct Basis {
  Vector3 right, forward, up;
};

Basis basis(const Matrix3& rotation, CameraAxes axes) {
  const Vector3 x = column(rotation, 0), y = column(rotation, 1), z = column(rotation, 2);
  switch (axes) {
    case CameraAxes::kRightForwardUp:
      return {x, y, z};
    case CameraAxes::kRightUpBackward:
      return {x, -z, y};
    case CameraAxes::kRightDownForward:
      return {x, z, -y};
  }
  throw Error("unknown axes of a camera");
}

}  // namespace

Matrix3 rotation_matrix(const Quaternion& q) {
  const double norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!(norm > 0) || !std::isfinite(norm))
    throw Error("a quaternion must be of finite length, other than zero");
  const double s = 2 / norm;
  return {1 - s * (q.y * q.y + q.z * q.z), s * (q.x * q.y - q.w * q.z),     s * (q.x * q.z + q.w * q.y),
          s * (q.x * q.y + q.w * q.z),     1 - s * (q.x * q.x + q.z * q.z), s * (q.y * q.z - q.w * q.x),
          s * (q.x * q.z - q.w * q.y),     s * (q.y * q.z + q.w * q.x),     1 - s * (q.x * q.x + q.y * q.y)};
}

bool is_rotation(const Matrix3& matrix, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const double product = dot(column(matrix, i), column(matrix, j));
      if (!(std::abs(product - (i == j ? 1 : 0)) <= tolerance)) return false;
    }
  }
  return determinant(matrix) > 0;
}

CameraPose camera_pose(const std::array<double, 3>& place, const Matrix3& rotation, CameraAxes axes) {
  const auto [right, forward, up] = basis(rotation, axes);
  // Rz(yaw) Rx(pitch) Ry(roll) has the bottom row (−cos p sin r, sin p, cos p cos r), and its middle column,
  // the way forward, is (−sin yaw cos p, cos yaw cos p, sin p).
  constexpr double kUpright = 1e-9;  // below this cosine of pitch, yaw and roll can't be told apart
  const double level = std::hypot(right[2], up[2]);
  const double pitch = std::atan2(forward[2], level);
  if (level < kUpright) return {place[0], place[1], place[2], std::atan2(right[1], right[0]), pitch, 0};
  return {
      place[0], place[1], place[2], std::atan2(-forward[0], forward[1]), pitch, std::atan2(-right[2], up[2])};
}

}  // namespace vkopple
