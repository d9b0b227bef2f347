#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace vkopple {

/// A camera's pose at a time, with the axes of the file's maker.
struct TimedPose {
  double time = 0;  ///< seconds
  std::array<double, 3> position{};
  std::array<double, 4> wxyz{};
};

/// Lines "timestamp tx ty tz qx qy qz qw", sorted by time; empty ones and those that begin with '#' are left
/// out. Throws Error, which names file and line.
std::vector<TimedPose> read_trajectory(const std::filesystem::path& path);

/// The one whose time is nearest, the earlier of two. `poses` are not empty.
const TimedPose& nearest_pose(const std::vector<TimedPose>& poses, double time);

/// A finite number and nothing else.
std::optional<double> parse_finite(std::string_view text);

}  // namespace vkopple
