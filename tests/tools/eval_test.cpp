#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tfrecord.h"
#include "tests/support/tiny_model.h"
#include "train/image_io.h"
#include "train/shards.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;

class EvalCommand : public testing::Test {
 protected:
  EvalCommand() { test::write_tiny_model(model()); }

  std::string model() const { return folder_ / "model.safetensors"; }
  Outcome eval(const std::string& data, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"eval", model(), "--data", data};
    words.insert(words.end(), more.begin(), more.end());
    return run_vkopple(words);
  }
  std::string generated(int scenes) const {
    const std::string out = folder_ / "rooms";
    expect_success(run_vkopple({"generate", out, "--scenes", std::to_string(scenes), "--seed", "5", "--size",
                                "16", "--frames", "3", "--config", "tiny"}));
    return out;
  }

  TempFolder folder_;
};

TEST_F(EvalCommand, ScoresRoomsAsJson) {
  const auto outcome = eval("rooms:2", {"--images", "3", "--json"});
  expect_success(outcome);
  EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  const json scores = json::parse(outcome.output);
  for (const char* key : {"ari_fg", "ari_fg_multi", "iou", "iou_objects", "depth_r", "angle_r", "distance_r"})
    EXPECT_TRUE(scores.contains(key)) << key;
  EXPECT_EQ(scores.at("images"), 3);
  EXPECT_GE(scores.at("skipped"), 0);
  EXPECT_GT(scores.at("iou"), 0.0);
}

TEST_F(EvalCommand, TheBatchChangesNoScore) {
  const auto one = eval("rooms:2", {"--images", "3", "--json", "--batch", "1"});
  const auto two = eval("rooms:2", {"--images", "3", "--json", "--batch", "2"});
  expect_success(one);
  const json a = json::parse(one.output), b = json::parse(two.output);
  EXPECT_NEAR(a.at("depth_r").get<double>(), b.at("depth_r").get<double>(), 1e-4);
  EXPECT_EQ(b.at("images"), 3);
}

TEST_F(EvalCommand, BaselinesStandBesideTheModel) {
  const auto plain = eval("rooms:2", {"--images", "3", "--json"});
  const auto outcome = eval("rooms:2", {"--images", "3", "--json", "--baselines"});
  expect_success(outcome);
  json scores = json::parse(outcome.output);
  const json baselines = scores.at("baselines");
  for (const char* name : {"background", "one_object", "random", "k_means", "truth"})
    EXPECT_TRUE(baselines.contains(name)) << name;
  EXPECT_GE(baselines.at("truth").at("iou"), scores.at("iou"));
  EXPECT_NEAR(baselines.at("truth").at("depth_r").get<double>(), 1, 1e-9);
  EXPECT_TRUE(baselines.at("k_means").at("depth_r").is_null());
  scores.erase("baselines");
  EXPECT_EQ(scores, json::parse(plain.output));
  const auto table = eval("rooms:2", {"--images", "3", "--baselines"});
  EXPECT_NE(table.output.find(" model  background  one object"), std::string::npos) << table.output;
}

TEST_F(EvalCommand, BaselinesNeedNoModel) {
  const std::vector<std::string> words{"eval", "--baselines", "--data", "rooms:9001", "--images",
                                       "2",    "--config",    "tiny",   "--set",      "rooms.supersample=1"};
  const auto more = [&](const std::vector<std::string>& others) {
    std::vector<std::string> all = words;
    all.insert(all.end(), others.begin(), others.end());
    return run_vkopple(all);
  };
  const auto outcome = more({"--json"});
  expect_success(outcome);
  EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  const json scores = json::parse(outcome.output);
  EXPECT_EQ(scores.at("images"), 2);
  EXPECT_EQ(scores.at("baselines").at("truth").at("iou"), 1.0);
  EXPECT_FALSE(scores.contains("iou"));
  EXPECT_NE(scores, json::parse(more({"--json", "--set", "rooms.objects=1"}).output));
  const auto ended = run_vkopple({"eval", "--baselines", "--data", generated(3), "--config", "tiny", "--set",
                                  "model.height=16", "--set", "model.width=16"});
  expect_success(ended);
  EXPECT_NE(ended.errors.find("3 of 200 images"), std::string::npos) << ended.errors;
  EXPECT_NE(ended.output.find("background  one object"), std::string::npos) << ended.output;
  expect_failure(more({"--grid", folder_ / "grid.png"}), 2, {"--grid", "model"});
  expect_failure(more({"--stage", "nap"}), 2, {"nap"});
}

TEST_F(EvalCommand, EndsWithTheData) {
  const auto outcome = eval(generated(3), {"--images", "10", "--json"});
  expect_success(outcome);
  EXPECT_EQ(json::parse(outcome.output).at("images"), 3);
  EXPECT_NE(outcome.errors.find("3 of 10 images"), std::string::npos) << outcome.errors;
}

TEST_F(EvalCommand, TheTableAndTheGrid) {
  const std::string grid = folder_ / "grid.png";
  const auto outcome = eval(generated(3), {"--images", "3", "--grid", grid, "--rows", "2"});
  expect_success(outcome);
  EXPECT_NE(outcome.output.find("ARI-fg"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.errors.find("image, inferred objects, true objects"), std::string::npos) << outcome.errors;
  const RgbImage picture = read_rgb(grid);
  EXPECT_EQ(picture.height, 2 * (128 + 4) + 4);
  EXPECT_EQ(picture.width, 5 * (128 + 4) + 4);
}

TEST_F(EvalCommand, NetworksThatHaveNotLearnedAreNamed) {
  test::write_tiny_model(model(), 0);
  const std::string grid = folder_ / "grid.png";
  const auto outcome = eval("rooms:2", {"--images", "1", "--grid", grid});
  expect_success(outcome);
  EXPECT_NE(outcome.errors.find("warning: networks that have not learned yet at step 4"), std::string::npos)
      << outcome.errors;
  EXPECT_EQ(outcome.errors.find("inferred objects"), std::string::npos) << outcome.errors;
  EXPECT_EQ(read_rgb(grid).width, 4 * (128 + 4) + 4);
}

TEST_F(EvalCommand, SaysWhenTheRoomsAreThoseOfTraining) {
  const auto outcome = eval("rooms:7", {"--images", "1"});
  expect_success(outcome);
  EXPECT_NE(outcome.errors.find("was trained on rooms:7"), std::string::npos) << outcome.errors;
}

TEST_F(EvalCommand, RefusesWrongUse) {
  expect_failure(eval("rooms:x"), 2, {"rooms:x"});
  expect_failure(eval("rooms:1", {"--stage", "nap"}), 2, {"nap", "depth, all"});
  expect_failure(eval("rooms:1", {"--images", "0"}), 2, {"--images"});
  expect_failure(eval("rooms:1", {"--rows", "2"}), 2, {"--grid"});
  expect_failure(run_vkopple({"eval", model()}), 2, {"--data"});
  expect_failure(run_vkopple({"eval", "--data", "rooms:1"}), 2, {"model", "--baselines"});
  expect_failure(eval("rooms:1", {"--baselines", "--config", "tiny"}), 2, {"--config", "model"});
  expect_failure(eval("rooms:1", {"--set", "model.fov=1"}), 2, {"--set", "model"});
}

TEST_F(EvalCommand, NamesWhatCannotBeRead) {
  expect_failure(eval(folder_ / "absent"), 1, {"absent"});
  expect_failure(eval(folder_.path()), 1, {folder_.path()});
}

TEST_F(EvalCommand, AGridThatCannotBeWrittenCostsNoScores) {
  const auto outcome = eval("rooms:2", {"--images", "1", "--json", "--grid", folder_ / "absent" / "grid.png"});
  expect_failure(outcome, 1, {"grid.png"});
  EXPECT_EQ(json::parse(outcome.output).at("images"), 1);
}

TEST_F(EvalCommand, NeedsTheTruth) {
  ShardReader reader(generated(1));
  auto sample = reader.next();
  ASSERT_TRUE(sample);
  std::erase_if(sample->parts, [](const auto& part) { return part.first.ends_with("exr"); });
  ShardWriter writer(folder_ / "blind", "blind", 1);
  writer.add(*sample);
  expect_failure(eval(folder_ / "blind"), 1, {"true labels"});
}

TEST_F(EvalCommand, OfClevrMasksAloneAreScored) {
  const std::string clevr = std::string(VKOPPLE_SOURCE_DIR) + "/tests/fixtures/records-clevr.tfrecord";
  const auto outcome = eval(clevr, {"--json", "--grid", folder_ / "grid.png"});
  expect_success(outcome);
  const json scores = json::parse(outcome.output);
  EXPECT_EQ(scores.at("images"), 1);
  EXPECT_EQ(scores.at("without_masks"), 0);
  EXPECT_EQ(scores.at("without_depth"), 1);
  EXPECT_GT(scores.at("iou"), 0.0);
  EXPECT_TRUE(scores.at("ari_fg_multi").is_number());
  for (const char* key : {"depth_r", "depth_r_pooled", "angle_r", "distance_r"})
    EXPECT_TRUE(scores.at(key).is_null());
  EXPECT_NE(outcome.errors.find("1 of 1 images have no true depth"), std::string::npos) << outcome.errors;
  EXPECT_NE(outcome.errors.find("where objects are is not known"), std::string::npos) << outcome.errors;
}

TEST_F(EvalCommand, WhatNeedsOptionsOfConvertIsSentThere) {
  records::Example example;
  test::set_bytes(example, "frames", {});
  test::set_floats(example, "camera_matrices", {});
  test::write_examples(folder_ / "a.tfrecord", {example});
  expect_failure(eval(folder_ / "a.tfrecord"), 1,
                 {"no feature 'depths'", "--map depth=NAME", "by vkopple convert, and use these"});
}

TEST_F(EvalCommand, FilmsOfAnotherAngleOfViewAreRefused) {
  expect_failure(eval(std::string(VKOPPLE_SOURCE_DIR) + "/tests/fixtures/records-gqn.tfrecord"), 1,
                 {"fov is 0.785", "set model.fov"});
}

}  // namespace
}  // namespace vkopple
