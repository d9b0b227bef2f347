#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace vkopple {
namespace {

using nlohmann::json;

// Somewhat below the scores in models/trained/README.md, and above what needs no learning, in 128 rooms that
// training never draws.
TEST(TrainedModel, FindsObjectsPlacesAndDepth) {
  const auto model = std::filesystem::path(VKOPPLE_SOURCE_DIR) / "models/trained/rooms-small.safetensors";
  EXPECT_LE(std::filesystem::file_size(model), 20'000'000U);
  const auto outcome = test::run_vkopple(
      {"eval", model.string(), "--data", "rooms:9001", "--images", "128", "--baselines", "--json"});
  test::expect_success(outcome);
  const json scores = json::parse(outcome.output);
  for (const auto& [name, baseline] : scores.at("baselines").items()) {
    if (name == "truth") continue;
    EXPECT_GT(scores.at("ari_fg"), baseline.at("ari_fg")) << name;
    EXPECT_GT(scores.at("iou"), baseline.at("iou")) << name;
  }
  EXPECT_GT(scores.at("ari_fg"), 0.65);
  EXPECT_GT(scores.at("iou"), 0.55);
  EXPECT_GT(scores.at("depth_r"), 0.92);
  EXPECT_GT(scores.at("angle_r"), 0.95);
  EXPECT_GT(scores.at("distance_r"), 0.60);
}

}  // namespace
}  // namespace vkopple
