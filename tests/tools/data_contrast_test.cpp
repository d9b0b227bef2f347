#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;

Outcome contrast(const std::string& data, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"data-contrast", "--data", data, "--config", "tiny"};
  words.insert(words.end(), more.begin(), more.end());
  return run_vkopple(words);
}

TEST(DataContrastCommand, TellsLossesAndWhatTheyMean) {
  const auto outcome = contrast("rooms:3", {"--images", "1"});
  expect_success(outcome);
  EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  EXPECT_TRUE(outcome.output.starts_with("rooms:3: 1 triplet of 32 x 32 pixels\n")) << outcome.output;
  EXPECT_NE(outcome.output.find("flat/ideal"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("A ratio well above 1"), std::string::npos) << outcome.output;
}

TEST(DataContrastCommand, TheConfigurationsRoomsAndAsManyAsAskedFor) {
  const auto outcome = contrast("rooms:3", {"--images", "9", "--json", "--set", "rooms.speed=0", "--set",
                                            "rooms.spin=0", "--set", "rooms.supersample=1"});
  expect_success(outcome);
  const auto said = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(said.at("triplets"), 9);
  EXPECT_GT(said.at("losses").at("ideal"), 0.0);
  EXPECT_NEAR(said.at("ratios").at("still").get<double>(), 1, 1e-6);
  EXPECT_GT(said.at("ratios").at("flat"), 1.0);
  EXPECT_GT(said.at("landed").at("ratios").at("flat"), 1.0);
}

TEST(DataContrastCommand, TheRoomsOfAStage) {
  const std::vector<std::string> stage{
      "--images", "1", "--json", "--config", "small", "--set", "model.height=16", "--set", "model.width=16"};
  const auto losses = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"data-contrast", "--data", "rooms:3"});
    const auto outcome = run_vkopple(words);
    expect_success(outcome);
    return nlohmann::json::parse(outcome.output).at("losses");
  };
  auto depth = stage;
  depth.insert(depth.end(), {"--stage", "depth"});
  EXPECT_NE(losses(stage), losses(depth));
}

TEST(DataContrastCommand, RefusesWhatItCannotMeasure) {
  expect_failure(contrast("rooms"), 2, {"--data rooms", "rooms:SEED"});
  expect_failure(contrast("rooms:x"), 2, {"rooms:x", "whole number"});
  expect_failure(contrast("rooms:1", {"--stage", "nap"}), 2, {"nap", "all"});
  expect_failure(contrast("rooms:1", {"--images", "0"}), 2, {"--images"});
  expect_failure(contrast("rooms:1", {"--set", "rooms.walls=3"}), 1, {"walls"});
  expect_failure(run_vkopple({"data-contrast"}), 2, {"--data"});
}

}  // namespace
}  // namespace vkopple
