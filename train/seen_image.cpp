#include "train/seen_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "train/evaluate.h"
#include "train/require_numbers.h"

namespace vkopple {
namespace {

double share_of(const Plane<std::uint32_t>& mask, std::uint32_t index) {
  const auto count = std::count(mask.pixels.begin(), mask.pixels.end(), index);
  return static_cast<double>(count) / static_cast<double>(mask.pixels.size());
}

void set_yaw(SeenObject& seen, std::span<const float> log_pose) {
  const auto best = std::max_element(log_pose.begin(), log_pose.end());
  const auto bin = static_cast<double>(best - log_pose.begin());
  seen.yaw = 2 * std::numbers::pi * bin / static_cast<double>(log_pose.size());
  for (const float log_probability : log_pose)
    seen.pose.push_back(std::exp(static_cast<double>(log_probability)));
  seen.yaw_probability = *std::max_element(seen.pose.begin(), seen.pose.end());
}

SeenObject object(std::span<const float> location, std::span<const float> log_pose,
                  std::span<const float> rotation) {
  SeenObject seen;
  std::copy(location.begin(), location.end(), seen.location.begin());
  seen.angle = std::atan2(seen.location[0], seen.location[1]);
  seen.distance = std::hypot(seen.location[0], seen.location[1]);
  if (rotation.empty())
    set_yaw(seen, log_pose);
  else
    std::copy(rotation.begin(), rotation.end(), seen.rotation.emplace().begin());
  return seen;
}

void count_shares(SeenImage& seen) {
  for (size_t k = 0; k < seen.objects.size(); ++k)
    seen.objects[k].share = share_of(seen.mask, static_cast<std::uint32_t>(k));
}

void add_objects(SeenImage& seen, const Percepts& percepts, size_t identity_numbers) {
  const auto indices = mask_indices(percepts.masks, static_cast<int64_t>(seen.background) + 1);
  std::copy(indices.begin(), indices.end(), seen.mask.pixels.begin());
  const size_t slots = seen.background;
  const auto of_slot = [&](const std::vector<float>& values, size_t k) {
    const size_t each = values.size() / slots;
    return std::span(values).subspan(each * k, each);
  };
  for (size_t k = 0; k < slots; ++k) {
    seen.objects.push_back(
        object(of_slot(percepts.location, k), of_slot(percepts.log_pose, k), of_slot(percepts.rotation, k)));
    const auto code = of_slot(percepts.code, k).first(identity_numbers);
    seen.objects.back().identity.assign(code.begin(), code.end());
  }
  count_shares(seen);
}

}  // namespace

SeenImage see_image(Perception& model, const RgbImage& image) {
  const Percepts percepts = model.see(image.pixels);
  for (const auto* values : {&percepts.depth, &percepts.masks, &percepts.location, &percepts.log_pose,
                             &percepts.rotation, &percepts.code})
    require_numbers(*values);
  SeenImage seen{{image.height, image.width}, {image.height, image.width}, {}};
  seen.background = static_cast<std::uint32_t>(model.config().slots);
  seen.depth.pixels = percepts.depth;
  std::fill(seen.mask.pixels.begin(), seen.mask.pixels.end(), seen.background);
  if (!percepts.masks.empty()) add_objects(seen, percepts, static_cast<size_t>(model.config().identity));
  seen.soft_masks = percepts.masks;
  return seen;
}

SeenImage resize(const SeenImage& seen, int height, int width) {
  SeenImage resized{resize_nearest(seen.mask, height, width), resize(seen.depth, height, width), seen.objects,
                    seen.background, seen.soft_masks};
  count_shares(resized);
  return resized;
}

double background_share(const SeenImage& seen) { return share_of(seen.mask, seen.background); }

nlohmann::ordered_json to_json(const SeenImage& seen) {
  auto objects = nlohmann::ordered_json::array();
  for (size_t k = 0; k < seen.objects.size(); ++k) {
    const SeenObject& o = seen.objects[k];
    objects.push_back({{"slot", k},
                       {"share", o.share},
                       {"location", o.location},
                       {"angle", o.angle},
                       {"distance", o.distance}});
    if (o.rotation) {
      objects.back()["rotation"] = *o.rotation;
    } else {
      objects.back()["yaw"] = o.yaw;
      objects.back()["yaw_probability"] = o.yaw_probability;
    }
  }
  return {{"height", seen.mask.height},
          {"width", seen.mask.width},
          {"background", {{"index", seen.background}, {"share", background_share(seen)}}},
          {"objects", objects}};
}

}  // namespace vkopple
