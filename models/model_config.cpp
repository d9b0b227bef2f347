#include "models/model_config.h"

#include <string>

namespace vkopple {
namespace {

constexpr int kLargestImage = 4096;
constexpr int kMostChannels = 1024;
// The pose resampling inverts a circulant matrix whose condition grows as exp(bins^2 / 800): beyond this double
// precision fails.
constexpr int kMostBins = 150;

}  // namespace

ModelConfig read_model_config(JsonObject object) {
  ModelConfig c;
  object.integer("height", c.height, 4, kLargestImage);
  object.integer("width", c.width, 4, kLargestImage);
  object.number("fov", c.fov, 0.05, 3.0);
  object.integer("slots", c.slots, 1, 32);
  object.integer("bins", c.bins, 3, kMostBins);
  object.integer("code", c.code, 1, kMostChannels);
  object.integer("identity", c.identity, 1, kMostChannels);
  object.integer("depth_width", c.depth_width, 1, kMostChannels);
  object.integer("object_width", c.object_width, 1, kMostChannels);
  object.integer("imagine_width", c.imagine_width, 1, kMostChannels);
  object.integer("lstm", c.lstm, 1, 4096);
  object.number("max_depth", c.max_depth, 0.01, 10000);
  object.number("max_height", c.max_height, 0.01, 10000);
  object.number("beta", c.beta, 0, 1000);
  object.number("reg", c.reg, 0, 1000);
  object.boolean("warp", c.warp);
  object.boolean("relaxed", c.relaxed);
  object.choice("pose_loss", c.pose_loss, kPoseLossNames);
  object.choice("statistics_frames", c.statistics_frames, kStatisticsFramesNames);
  object.numbers("dropout", c.dropout, 0, 0.95);
  object.finish();
  if (c.identity > c.code) {
    object.refuse("identity", "is " + std::to_string(c.identity) + "; give at most code, which is " +
                                  std::to_string(c.code));
  }
  if (c.relaxed) object.refuse("relaxed", "is true, but learned motion is not built yet; give false");
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
          {"max_depth", c.max_depth},
          {"max_height", c.max_height},
          {"beta", c.beta},
          {"reg", c.reg},
          {"warp", c.warp},
          {"relaxed", c.relaxed},
          {"pose_loss", kPoseLossNames[static_cast<std::size_t>(c.pose_loss)]},
          {"statistics_frames", kStatisticsFramesNames[static_cast<std::size_t>(c.statistics_frames)]},
          {"dropout", c.dropout}};
}

ModelConfig ModelConfig::parse(std::string_view text, std::string_view origin) {
  const nlohmann::json value = parse_strict_json(text, origin);
  return read_model_config(JsonObject(value, std::string(origin), ""));
}

}  // namespace vkopple
