#include "train/frame_poses.h"

#include <fmt/format.h>

#include <cmath>

#include "train/formats/scene.h"
#include "train/json_io.h"

namespace vkopple {
namespace {

CameraPose read_pose(const JsonView& view) {
  const std::vector<double> numbers = view.numbers(6);
  CameraPose pose{};
  for (size_t i = 0; i < pose.size(); ++i) {
    if (std::abs(numbers[i]) > kFarthest) view.fail(fmt::format("numbers up to {}", kFarthest));
    pose[i] = numbers[i];
  }
  return pose;
}

}  // namespace

std::array<CameraPose, 3> read_frame_poses(const std::filesystem::path& path, const std::array<int, 3>& frames,
                                           double fov) {
  const Json json = read_json(path);
  const JsonView root(json, path.string());
  const bool scene = root.contains("frames");
  const JsonView list = scene ? root["frames"] : root["poses"];
  if (scene && std::abs(root["fov"].number() - fov) > 1e-6)
    root["fov"].fail(fmt::format("the model's angle of view, {}", fov));
  std::array<CameraPose, 3> poses{};
  for (size_t i = 0; i < poses.size(); ++i) {
    const auto frame = static_cast<size_t>(frames[i]);
    if (list.size() <= frame) list.fail(fmt::format("a list of more than {} frames", frame));
    poses[i] = read_pose(scene ? list[frame]["camera"] : list[frame]);
  }
  return poses;
}

}  // namespace vkopple
