#include "models/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace vkopple {
namespace {

/// GLM's matrices are columns of rows; ours rows of columns.
glm::dmat4 to_glm(const CameraPose& pose) {
  const glm::dmat4 one(1.0);
  const auto turn = [&](double angle, glm::dvec3 axis) { return glm::rotate(one, angle, axis); };
  return glm::translate(one, glm::dvec3(pose[0], pose[1], pose[2])) * turn(pose[3], {0, 0, 1}) *
         turn(pose[4], {1, 0, 0}) * turn(pose[5], {0, 1, 0});
}

Matrix4 from_glm(const glm::dmat4& m) {
  Matrix4 out{};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out[static_cast<size_t>(4 * row + column)] = m[column][row];
  return out;
}

}  // namespace

Matrix4 camera_to_world(const CameraPose& pose) { return from_glm(to_glm(pose)); }

Matrix4 relative(const CameraPose& a, const CameraPose& b) {
  return from_glm(glm::inverse(to_glm(b)) * to_glm(a));
}

std::array<double, 3> ego_motion(const CameraPose& a, const CameraPose& b) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double c = std::cos(a[3]);
  const double s = std::sin(a[3]);
  const double x = b[0] - a[0];
  const double y = b[1] - a[1];
  const double turn = b[3] - a[3] + std::numbers::pi;
  return {c * x + s * y, -s * x + c * y, turn - kTurn * std::floor(turn / kTurn) - std::numbers::pi};
}

std::array<double, 3> euler_angles(const std::array<double, 9>& rotation) {
  const std::array<double, 9>& m = rotation;
  const double level = std::hypot(m[1], m[4]);  // of the forward axis, the second column
  const double pitch = std::atan2(m[7], level);
  if (level <= 1e-9) return {std::atan2(m[3], m[0]), pitch, 0};
  return {std::atan2(-m[1], m[4]), pitch, std::atan2(-m[6], m[8])};
}

std::array<double, 6> spatial_ego_motion(const CameraPose& a, const CameraPose& b) {
  const glm::dmat4 step = glm::inverse(to_glm(a)) * to_glm(b);
  glm::dquat turn = glm::normalize(glm::quat_cast(glm::dmat3(step)));
  if (turn.w < 0) turn = -turn;
  const glm::dvec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis);
  const glm::dvec3 vector = axis * (sine > 0 ? 2 * std::atan2(sine, turn.w) / sine : 2.0);
  return {step[3][0], step[3][1], step[3][2], vector.x, vector.y, vector.z};
}

uint32_t resampling_index(double angle) {
  const double degrees = std::nearbyint(angle * 180 / std::numbers::pi);
  return static_cast<uint32_t>(std::clamp(degrees, -180.0, 180.0) + 180);
}

}  // namespace vkopple
