#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/small_scene.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/formats/scene_reader.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::run_vkopple;
using test::TempFolder;

class ConvertCommand : public testing::Test {
 protected:
  ConvertCommand() {
    const auto writer = create_scenes(recording(), "recording");
    for (int i = 0; i < 3; ++i) writer->add(test::small_scene(i, 3));
    writer->finish();
  }
  std::string recording() const { return folder_ / "recording"; }
  std::string out() const { return folder_ / "out"; }
  test::Outcome convert(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"convert", recording(), out()});
    return run_vkopple(more);
  }

  TempFolder folder_;
};

TEST_F(ConvertCommand, WritesShards) {
  const auto outcome = convert({"--limit", "2", "--size", "4", "--scale", "2"});
  expect_success(outcome);
  EXPECT_EQ(outcome.output, out() + ": 2 scenes, 6 frames\n");
  EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  const auto reader = open_scenes(out(), "shards");
  const auto scene = reader->next();
  ASSERT_TRUE(scene && reader->next());
  EXPECT_FALSE(reader->next());
  EXPECT_EQ(scene->frames[0].image.width, 4);
  EXPECT_EQ((*scene->frames[0].camera)[2], 1.4);
}

TEST_F(ConvertCommand, ThereAndBack) {
  expect_success(convert({"--to-option", "scenes_per_shard=2"}));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / "scenes-000001.tar"));
  const std::string back = folder_ / "back";
  const auto outcome = run_vkopple({"convert", out(), back, "--to", "recording", "--json"});
  expect_success(outcome);
  EXPECT_EQ(json::parse(outcome.output)["frames"], 9);
  const auto reader = open_scenes(back);
  for (int i = 0; i < 3; ++i) {
    const auto scene = reader->next();
    ASSERT_TRUE(scene);
    test::expect_same(*scene, test::small_scene(i, 3));
  }
  expect_success(run_vkopple(
      {"convert", out(), folder_ / "authors", "--to", "authors", "--to-option", "fov=71.61972439"}));
  EXPECT_EQ(detect_format(folder_ / "authors").name, "authors");
}

TEST_F(ConvertCommand, RefusesWrongUse) {
  expect_failure(convert({"--to", "nap"}), 2, {"'nap'"});
  expect_failure(convert({"--to", "tum"}), 2, {"tum"});
  expect_failure(convert({"--format", "nap"}), 2, {"'nap'"});
  expect_failure(convert({"--format-option", "fov"}), 2, {"--format-option", "NAME=VALUE"});
  expect_failure(convert({"--format-option", "fov=3"}), 2, {"fov=3"});
  expect_failure(convert({"--map", "image=frames"}), 2, {"image=frames"});
  expect_failure(convert({"--to-option", "x=3"}), 2, {"--to-option x=3", "shards knows scenes_per_shard"});
  expect_failure(convert({"--to-option", "scenes_per_shard=0"}), 2, {"--to-option scenes_per_shard=0", "1 to"});
  expect_failure(convert({"--to", "recording", "--to-option", "every=2"}), 2, {"--to-option every=2", "none"});
  expect_failure(convert({"--size", "1"}), 2, {"--size"});
  expect_failure(convert({"--limit", "0"}), 2, {"--limit"});
  expect_failure(convert({"--scale", "0"}), 2, {"--scale"});
  expect_failure(convert({"--fov", "80"}), 1, {"71.62", "80"});
  expect_failure(run_vkopple({"convert", folder_ / "absent", out()}), 1, {"absent"});
  expect_success(convert({"--fov", "50"}));
  expect_failure(convert(), 1, {"out", "already"});
}

TEST_F(ConvertCommand, ForeignDataIsTrainedOnAndScoredAsItIs) {
  write_file(folder_ / "config.json", R"({
      "model": {"height": 16, "width": 24, "fov": 1.25, "slots": 2, "bins": 12, "code": 12, "depth_width": 2,
                "object_width": 4, "imagine_width": 1, "lstm": 4},
      "training": {"stages": [{"networks": ["depth"], "hypotheses": "background"}]}})");
  const std::string run = folder_ / "run";
  const auto train = [&](const std::string& data, const std::vector<std::string>& more) {
    std::vector<std::string> words{"train", "--data", data, "--out", run, "--batch", "2", "--eval-every", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run_vkopple(words);
  };
  expect_success(train(recording(), {folder_ / "config.json", "--steps", "2", "--data-threads", "3"}));
  const auto scores = run_vkopple({"eval", run + "/latest.safetensors", "--data", recording(), "--json"});
  expect_success(scores);
  EXPECT_EQ(json::parse(scores.output)["images"], 3);
  const auto other = run_vkopple({"train", folder_ / "config.json", "--set", "model.fov=1.5", "--data",
                                  recording(), "--out", folder_ / "other"});
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.errors.find("fov is 1.25 and the model's 1.5"), std::string::npos) << other.errors;
}

TEST_F(ConvertCommand, DataInfoTellsWhatIsThere) {
  const auto table = run_vkopple({"data-info", recording()});
  expect_success(table);
  EXPECT_NE(table.output.find("scenes                3\n"), std::string::npos) << table.output;
  EXPECT_EQ(table.output.find("warning"), std::string::npos) << table.output;
  const auto outcome = run_vkopple({"data-info", recording(), "--json", "--limit", "2"});
  expect_success(outcome);
  EXPECT_EQ(json::parse(outcome.output)["scenes"], 2);
  expect_failure(run_vkopple({"data-info", folder_ / "absent"}), 1, {"absent"});
}

}  // namespace
}  // namespace vkopple
