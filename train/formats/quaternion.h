#pragma once

#include <array>

#include "models/camera.h"

namespace vkopple {

// Rotations as data sets give them, turned into the model's poses (docs/model.md §1).

/// Of any length but zero; (w, x, y, z) and its negative are one rotation.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

/// A 3×3 matrix, row-major.
using Matrix3 = std::array<double, 9>;

/// Throws Error where the quaternion's length is zero or not finite.
Matrix3 rotation_matrix(const Quaternion& quaternion);

/// Whether the columns are perpendicular, of length one and right-handed, to within `tolerance` an entry of
/// RᵀR.
bool is_rotation(const Matrix3& matrix, double tolerance);

/// Which way the axes of a camera of others point.
enum class CameraAxes {
  kRightForwardUp,    ///< the model's own
  kRightUpBackward,   ///< OpenGL, Blender, Kubric: it looks along −z
  kRightDownForward,  ///< OpenCV, TUM: it looks along z
};

/// The pose of a camera at `place` whose axes `rotation` turns into the world's, which is right-handed with z
/// up. Pitch is from −π/2 to π/2; where it is ±π/2 yaw and roll turn about one axis, and roll is 0.
CameraPose camera_pose(const std::array<double, 3>& place, const Matrix3& rotation, CameraAxes axes);

}  // namespace vkopple
