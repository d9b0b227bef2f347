#include "models/model_config.h"

#include <string>

namespace vkopple {
namespace {

constexpr int kMostChannels = 1024;
constexpr int kMostBins = 3600;  // a tenth of a degree each

}  // namespace

ModelConfig read_model_config(JsonObject object) {
  ModelConfig c;
  object.integer("height", c.height, kSmallestImage, kLargestImage);
  object.integer("width", c.width, kSmallestImage, kLargestImage);
  object.number("fov", c.fov, 0.05, 3.0);
  object.integer("slots", c.slots, 1, kMostSlots);
  object.integer("bins", c.bins, 1, kMostBins);
  object.integer("code", c.code, 1, kMostChannels);
  object.integer("identity", c.identity, 1, kMostChannels);
  object.integer("depth_width", c.depth_width, 1, kMostChannels);
  object.integer("object_width", c.object_width, 1, kMostChannels);
  object.integer("imagine_width", c.imagine_width, 1, kMostChannels);
  object.integer("lstm", c.lstm, 1, 4096);
  object.integer("slot_counters", c.slot_counters, 0, kMostSlots);
  object.number("max_depth", c.max_depth, 0.01, 10000);
  object.number("max_height", c.max_height, 0.01, 10000);
  object.number("beta", c.beta, 0, 1000);
  object.number("mask_window", c.mask_window, 0, 10000);
  object.boolean("mask_location", c.mask_location);
  object.number("reg", c.reg, 0, 1000);
  object.number("smoothness", c.smoothness, 0, 1000);
  object.number("pose_contrast", c.pose_contrast, 0, 1000);
  object.number("slot_contrast", c.slot_contrast, 0, 1000);
  object.boolean("warp", c.warp);
  object.boolean("relaxed", c.relaxed);
  object.choice("orientation", c.orientation, kOrientationNames);
  object.choice("pose_loss", c.pose_loss, kPoseLossNames);
  object.choice("statistics_frames", c.statistics_frames, kStatisticsFramesNames);
  object.choice("mask_statistics", c.mask_statistics, kMaskStatisticsNames);
  object.numbers("dropout", c.dropout, 0, 0.95);
  object.finish();
  if (c.identity > c.code) {
    object.refuse("identity", "is " + std::to_string(c.identity) + "; give at most code, which is " +
                                  std::to_string(c.code));
  }
  if (c.slot_counters > c.identity || c.slot_counters >= c.lstm) {
    object.refuse("slot_counters", "is " + std::to_string(c.slot_counters) +
                                       "; give at most identity, and fewer than lstm, which are " +
                                       std::to_string(c.identity) + " and " + std::to_string(c.lstm));
  }
  if (c.orientation != Orientation::kYaw) {
    if (c.relaxed)
      object.refuse("relaxed",
                    "is true, but learned motion reads yaw; give orientation \"yaw\", or false here");
    if (c.pose_contrast > 0)
      object.refuse("pose_contrast", "compares yaws; give orientation \"yaw\", or 0 here");
  }
  return c;
}

nlohmann::ordered_json write_model_config(const ModelConfig& c) {
  return {{"height", c.height},
          {"width", c.width},
          {"fov", c.fov},
          {"slots", c.slots},
          {"bins", c.bins},
          {"identity", c.identity},
          {"code", c.code},
          {"depth_width", c.depth_width},
          {"object_width", c.object_width},
          {"imagine_width", c.imagine_width},
          {"lstm", c.lstm},
          {"slot_counters", c.slot_counters},
          {"max_depth", c.max_depth},
          {"max_height", c.max_height},
          {"beta", c.beta},
          {"mask_window", c.mask_window},
          {"mask_location", c.mask_location},
          {"reg", c.reg},
          {"smoothness", c.smoothness},
          {"pose_contrast", c.pose_contrast},
          {"slot_contrast", c.slot_contrast},
          {"warp", c.warp},
          {"relaxed", c.relaxed},
          {"orientation", kOrientationNames[static_cast<std::size_t>(c.orientation)]},
          {"pose_loss", kPoseLossNames[static_cast<std::size_t>(c.pose_loss)]},
          {"statistics_frames", kStatisticsFramesNames[static_cast<std::size_t>(c.statistics_frames)]},
          {"mask_statistics", kMaskStatisticsNames[static_cast<std::size_t>(c.mask_statistics)]},
          {"dropout", c.dropout}};
}

ModelConfig ModelConfig::parse(std::string_view text, std::string_view origin) {
  const nlohmann::json value = parse_strict_json(text, origin);
  return read_model_config(JsonObject(value, std::string(origin), ""));
}

}  // namespace vkopple
