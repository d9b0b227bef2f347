#pragma once

#include <array>
#include <filesystem>

#include "models/camera.h"

namespace vkopple {

/// Reads the camera's poses in three frames: {"poses": [[x, y, z, yaw, pitch, roll], ...]}, or a scene of a
/// data set (docs/data.md), which must have the angle of view `fov`. `frames` are chosen, counted from 0.
/// Throws Error naming file and place.
std::array<CameraPose, 3> read_frame_poses(const std::filesystem::path& path, const std::array<int, 3>& frames,
                                           double fov);

}  // namespace vkopple
