#include "train/formats/data_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "train/data/triplets.h"

namespace vkopple {
namespace {

using nlohmann::ordered_json;

constexpr double kStill = 1e-6;            // scene units, radians
constexpr double kTooManySaturated = 0.1;  // of the pixels
constexpr double kTooManyStill = 0.5;      // of the scenes
constexpr double kTooTilted = 30;          // degrees of pitch or roll

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

bool moves(const CameraPose& from, const CameraPose& to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    if (std::abs(from[i] - to[i]) > kStill) return true;
  return false;
}

}  // namespace

ordered_json NumberRange::to_json() const {
  if (count_ == 0) return nullptr;
  return {{"min", least_}, {"max", largest_}, {"mean", mean()}};
}

std::string NumberRange::to_text(const std::string& unit) const {
  if (count_ == 0) return "unknown";
  if (largest_ - least_ <= 1e-9 * std::abs(largest_)) return fmt::format("{:.4g}{}", largest_, unit);
  return fmt::format("{:.4g} to {:.4g}, mean {:.4g}{}", least_, largest_, mean(), unit);
}

void DataSummary::add(const SceneData& scene) {
  ++scenes_;
  all_frames_ += scene.frames.size();
  frames_.add(static_cast<double>(scene.frames.size()));
  fov_.add(degrees(scene.fov));
  triplets_ += strided_triplets(static_cast<int>(scene.frames.size())).size();
  if (scene.frames.size() < 3) ++short_scenes_;
  bool still = scene.frames.size() > 1;
  const SceneFrame* before = nullptr;
  for (const SceneFrame& frame : scene.frames) {
    add_frame(frame);
    if (before != nullptr && before->camera && frame.camera) {
      add_step(*before->camera, *frame.camera);
      still = still && !moves(*before->camera, *frame.camera);
    }
    still = still && frame.camera;
    before = &frame;
  }
  if (still) ++still_scenes_;
}

void DataSummary::add_frame(const SceneFrame& frame) {
  ++sizes_[{frame.image.width, frame.image.height}];
  if (frame.camera) {
    height_.add((*frame.camera)[2]);
    pitch_.add(degrees((*frame.camera)[4]));
    roll_.add(degrees((*frame.camera)[5]));
  } else {
    ++without_camera_;
  }
  if (!frame.depth.pixels.empty()) add_depth(frame.depth);
  if (!frame.ids.pixels.empty()) {
    ++with_labels_;
    const auto background = std::count(frame.ids.pixels.begin(), frame.ids.pixels.end(), 0U);
    object_share_.add(1 - share(static_cast<std::uint64_t>(background), frame.ids.pixels.size()));
  }
  if (!frame.objects) return;
  ++with_objects_;
  objects_.add(static_cast<double>(frame.objects->size()));
}

void DataSummary::add_step(const CameraPose& from, const CameraPose& to) {
  step_.add(std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
  turn_.add(degrees(std::abs(ego_motion(from, to)[2])));
}

void DataSummary::add_depth(const Plane<float>& depth) {
  ++with_depth_;
  const float largest = *std::max_element(depth.pixels.begin(), depth.pixels.end());
  for (const float z : depth.pixels) {
    ++depth_pixels_;
    if (z > 0) depth_.add(static_cast<double>(z));
    if (z == 0) ++unknown_depth_;
    if (z > 0 && z == largest) ++saturated_depth_;
  }
}

std::vector<std::string> DataSummary::warnings() const {
  std::vector<std::string> all;
  if (scenes_ == 0) all.push_back("no scenes");
  if (without_camera_ > 0)
    all.push_back(
        fmt::format("{} of {} frames have no camera pose, which training needs", without_camera_, all_frames_));
  if (short_scenes_ > 0)
    all.push_back(fmt::format("{} of {} scenes have less than the three frames that training needs",
                              short_scenes_, scenes_));
  if (share(still_scenes_, scenes_) > kTooManyStill)
    all.push_back(
        fmt::format("the camera stands still in {} of {} scenes: depth and objects are learned from its "
                    "motion",
                    still_scenes_, scenes_));
  if (share(saturated_depth_, depth_pixels_) > kTooManySaturated)
    all.push_back(
        fmt::format("depth is saturated: {:.0f} % of the pixels have the largest depth of their frame",
                    100 * share(saturated_depth_, depth_pixels_)));
  if (sizes_.size() > 1) all.push_back(fmt::format("pictures are of {} sizes", sizes_.size()));
  if (fov_.count() > 0 && fov_.largest() - fov_.least() > 1e-4)
    all.push_back("scenes have different angles of view, and a model has one: choose it by convert --fov");
  if (pitch_.count() > 0 &&
      std::max({-pitch_.least(), pitch_.largest(), -roll_.least(), roll_.largest()}) > kTooTilted)
    all.push_back(
        fmt::format("the camera is tilted by more than {} degrees somewhere: are its axes right?", kTooTilted));
  return all;
}

ordered_json DataSummary::to_json() const {
  ordered_json sizes = ordered_json::array();
  for (const auto& [size, count] : sizes_)
    sizes.push_back({{"width", size.first}, {"height", size.second}, {"frames", count}});
  return {{"scenes", scenes_},
          {"frames_a_scene", frames_.to_json()},
          {"triplets", triplets_},
          {"sizes", sizes},
          {"fov", fov_.to_json()},
          {"camera",
           {{"missing", without_camera_},
            {"step", step_.to_json()},
            {"turn", turn_.to_json()},
            {"height", height_.to_json()},
            {"pitch", pitch_.to_json()},
            {"roll", roll_.to_json()}}},
          {"depth",
           {{"frames", with_depth_},
            {"range", depth_.to_json()},
            {"unknown_share", share(unknown_depth_, depth_pixels_)},
            {"saturated_share", share(saturated_depth_, depth_pixels_)}}},
          {"labels", {{"frames", with_labels_}, {"object_share", object_share_.to_json()}}},
          {"objects", {{"frames", with_objects_}, {"count", objects_.to_json()}}},
          {"warnings", warnings()}};
}

std::string DataSummary::to_text() const {
  std::string sizes;
  for (const auto& [size, count] : sizes_)
    sizes += fmt::format("{}{} x {}", sizes.empty() ? "" : ", ", size.first, size.second);
  std::string text;
  const auto row = [&](const std::string& name, const std::string& value) {
    text += fmt::format("{:<22}{}\n", name, value);
  };
  row("scenes", std::to_string(scenes_));
  row("frames a scene", frames_.to_text());
  row("triplets", std::to_string(triplets_));
  row("pixels", sizes);
  row("angle of view", fov_.to_text(" degrees, vertical"));
  row("camera step", step_.to_text());
  row("camera turn", turn_.to_text(" degrees"));
  row("camera height", height_.to_text());
  row("camera pitch", pitch_.to_text(" degrees"));
  row("camera roll", roll_.to_text(" degrees"));
  row("depth", depth_.to_text());
  if (depth_pixels_ > 0)
    row("depth unknown", fmt::format("{:.3g} of the pixels", share(unknown_depth_, depth_pixels_)));
  row("pixels of objects", object_share_.to_text());
  row("objects", objects_.to_text());
  return text;
}

}  // namespace vkopple
