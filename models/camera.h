#pragma once

#include <array>
#include <cstdint>

namespace vkopple {

// Camera geometry on the host, in double (docs/model.md §1). Lengths in scene units, angles in radians.

/// x, y, z, yaw, pitch, roll of the camera in the world; yaw counter-clockwise seen from above.
using CameraPose = std::array<double, 6>;

/// A 4×4 matrix, row-major.
using Matrix4 = std::array<double, 16>;

/// Camera to world: rotation Rz(yaw) · Rx(pitch) · Ry(roll), then the camera's place.
Matrix4 camera_to_world(const CameraPose& pose);

/// The map of a static point from camera a's frame to camera b's.
Matrix4 relative(const CameraPose& a, const CameraPose& b);

/// (v_x, v_y, ω): the camera's step in a's heading and its turn, wrapped to [−π, π) as PyTorch's remainder
/// does.
std::array<double, 3> ego_motion(const CameraPose& a, const CameraPose& b);

/// Yaw, pitch and roll of a rotation Rz(yaw) · Rx(pitch) · Ry(roll), row-major; pitch from −π/2 to π/2.
/// Straight up and down, where yaw and roll turn about the same axis, roll is 0.
std::array<double, 3> euler_angles(const std::array<double, 9>& rotation);

/// The camera's step in a's frame, and its turn from a to b in a's frame as a vector: the axis, as long as the
/// angle, which is at most π.
std::array<double, 6> spatial_ego_motion(const CameraPose& a, const CameraPose& b);

/// Index of the resampling matrix of an angle in [−π, π]: whole degrees, halves to even, plus 180.
uint32_t resampling_index(double angle);

}  // namespace vkopple
