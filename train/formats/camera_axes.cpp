#include "train/formats/camera_axes.h"

#include <fmt/format.h>

#include <cmath>

#include "runtime/error.h"

namespace vkopple {
namespace {

using Vector = std::array<double, 3>;

/// A direction of our camera's frame with the axes of theirs.
Vector to_their_camera(const Vector& v, CameraAxes axes) {
  switch (axes) {
    case CameraAxes::kOwn:
      return v;
    case CameraAxes::kOptical:
      return {v[0], -v[2], v[1]};
    case CameraAxes::kGraphics:
      return {v[0], v[2], -v[1]};
    case CameraAxes::kBody:
      return {v[1], -v[0], v[2]};
  }
  throw Error("unknown axes of a camera");
}

/// v turned by the unit quaternion w, u: v + 2 u × (u × v + w v).
Vector rotated(const std::array<double, 4>& q, const Vector& v) {
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Vector u{q[1], q[2], q[3]};
  Vector inner = cross(u, v);
  for (std::size_t i = 0; i < 3; ++i) inner[i] += q[0] * v[i];
  const Vector outer = cross(u, inner);
  return {v[0] + 2 * outer[0], v[1] + 2 * outer[1], v[2] + 2 * outer[2]};
}

std::array<double, 4> normalised(const std::array<double, 4>& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) < 0.01))
    throw Error(fmt::format("({}, {}, {}, {}) is no unit quaternion", q[0], q[1], q[2], q[3]));
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

/// Whether the columns are of length 1, perpendicular and right-handed.
bool is_rotation(const std::array<double, 9>& m) {
  constexpr double kTolerance = 1e-3;  // of matrices in float32, which were multiplied a few times
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const double product = m[i] * m[j] + m[3 + i] * m[3 + j] + m[6 + i] * m[6 + j];
      if (!(std::abs(product - (i == j ? 1 : 0)) <= kTolerance)) return false;
    }
  }
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
             m[2] * (m[3] * m[7] - m[4] * m[6]) >
         0;
}

/// The pose of a camera whose frame `turn` turns to the world's.
template <class Turn>
CameraPose pose_of(const Vector& position, const Turn& turn, CameraAxes camera, WorldAxes world) {
  const auto seen = [&](const Vector& axis) {
    return to_own_world(turn(to_their_camera(axis, camera)), world);
  };
  const Vector right = seen({1, 0, 0}), forward = seen({0, 1, 0}), up = seen({0, 0, 1});
  const Vector place = to_own_world(position, world);
  const Vector angles =
      euler_angles({right[0], forward[0], up[0], right[1], forward[1], up[1], right[2], forward[2], up[2]});
  return {place[0], place[1], place[2], angles[0], angles[1], angles[2]};
}

}  // namespace

std::map<std::string, CameraAxes> camera_axes_by_name() {
  return {{"own", CameraAxes::kOwn},
          {"optical", CameraAxes::kOptical},
          {"graphics", CameraAxes::kGraphics},
          {"body", CameraAxes::kBody}};
}

std::map<std::string, WorldAxes> world_axes_by_name() {
  return {{"z-up", WorldAxes::kZUp}, {"y-up", WorldAxes::kYUp}, {"y-down", WorldAxes::kYDown}};
}

Vector to_own_world(const Vector& point, WorldAxes world) {
  switch (world) {
    case WorldAxes::kZUp:
      return point;
    case WorldAxes::kYUp:
      return {point[0], -point[2], point[1]};
    case WorldAxes::kYDown:
      return {point[0], point[2], -point[1]};
  }
  throw Error("unknown axes of a world");
}

CameraPose own_pose(const Vector& position, const std::array<double, 4>& wxyz, CameraAxes camera,
                    WorldAxes world) {
  const std::array<double, 4> q = normalised(wxyz);
  return pose_of(
      position, [&](const Vector& v) { return rotated(q, v); }, camera, world);
}

CameraPose own_pose_of_matrix(const Vector& position, const std::array<double, 9>& rotation, CameraAxes camera,
                              WorldAxes world) {
  const std::array<double, 9>& m = rotation;
  if (!is_rotation(m)) throw Error("the camera's matrix is no rotation");
  const auto turn = [&](const Vector& v) {
    return Vector{m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
                  m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
  };
  return pose_of(position, turn, camera, world);
}

void planar_to_euclidean(Plane<float>& depth, double fov) {
  const double focal = depth.height / 2.0 / std::tan(fov / 2);
  std::size_t i = 0;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x, ++i) {
      const double right = (x + 0.5 - depth.width / 2.0) / focal, up = (depth.height / 2.0 - y - 0.5) / focal;
      depth.pixels[i] = static_cast<float>(depth.pixels[i] * std::sqrt(1 + right * right + up * up));
    }
  }
}

}  // namespace vkopple
