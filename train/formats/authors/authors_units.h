#pragma once

#include <array>

#include "train/formats/scene.h"

namespace vkopple {

// The authors' rooms are left-handed with y up, lengths in tenths, angles in degrees, yaw clockwise.

/// X, Y, Z, yaw, pitch, roll as their files have them.
using AuthorsPose = std::array<double, 6>;

CameraPose own_camera(const AuthorsPose& pose);
AuthorsPose authors_camera(const CameraPose& pose);

/// `location`: X, Y, Z; `pose`: yaw, pitch, roll, of which yaw counts from another direction than a camera's.
PlacedObject own_object(const std::array<double, 3>& location, const std::array<double, 3>& pose);
/// An object whose yaw is unknown has 0.
std::array<double, 3> authors_location(const PlacedObject& object);
std::array<double, 3> authors_object_pose(const PlacedObject& object);

}  // namespace vkopple
