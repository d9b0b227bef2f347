#pragma once

#include <array>
#include <map>
#include <string>

#include "models/camera.h"
#include "train/image.h"

namespace vkopple {

/// How others lay the axes of a camera's frame.
enum class CameraAxes {
  kOwn,       ///< x right, y forward, z up
  kOptical,   ///< x right, y down, z forward: computer vision, TUM, ROS's optical frames
  kGraphics,  ///< x right, y up, z backward: OpenGL, Blender
  kBody,      ///< x forward, y left, z up: robots
};

/// Which way is up in others' worlds.
enum class WorldAxes {
  kZUp,    ///< ours
  kYUp,    ///< right-handed: x, y, z become x, -z, y
  kYDown,  ///< right-handed, as a first camera of optical axes sees it: x, y, z become x, z, -y
};

/// By the names that users give them: own, optical, graphics, body; z-up, y-up, y-down.
std::map<std::string, CameraAxes> camera_axes_by_name();
std::map<std::string, WorldAxes> world_axes_by_name();

/// A point or direction of another's world in ours.
std::array<double, 3> to_own_world(const std::array<double, 3>& point, WorldAxes world);

/// The pose of a camera at `position` whose frame the unit quaternion `wxyz` turns to the world's: both with
/// others' axes. The quaternion is normalised first. Throws Error where its length is not about 1.
CameraPose own_pose(const std::array<double, 3>& position, const std::array<double, 4>& wxyz, CameraAxes camera,
                    WorldAxes world);

/// The same of a rotation matrix, row-major. Throws Error where it is none, to within 1e-3.
CameraPose own_pose_of_matrix(const std::array<double, 3>& position, const std::array<double, 9>& rotation,
                              CameraAxes camera, WorldAxes world);

/// Turns distances along the optical axis to Euclidean ones; 0 stays 0. `fov`: vertical angle of view, radians.
void planar_to_euclidean(Plane<float>& depth, double fov);

}  // namespace vkopple
