#include "train/training_log.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::TempFolder;

StepRecord record(uint64_t step) {
  return {.step = step,
          .stage = "depth",
          .batch = 4,
          .losses = {{"image", 0.5}, {"total", 0.25}},
          .data_seconds = 0.5,
          .seconds = 2};
}

std::vector<nlohmann::json> lines(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<nlohmann::json> all;
  std::string line;
  while (std::getline(file, line)) all.push_back(nlohmann::json::parse(line));
  return all;
}

TEST(TrainingLog, OneObjectAStep) {
  const TempFolder folder;
  TrainingLog log(folder / "log.jsonl", 0);
  log.add(record(1));
  StepRecord measured = record(2);
  measured.held_out = {.ari_fg = {}, .iou = 0.25, .depth_r = 0.75};
  log.add(measured);
  const auto all = lines(folder / "log.jsonl");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(
      all[0],
      nlohmann::json::parse(
          R"({"step":1,"stage":"depth","losses":{"image":0.5,"total":0.25},"seconds":2.0,"data_seconds":0.5})"));
  EXPECT_EQ(all[1].at("depth_r"), 0.75);
  EXPECT_EQ(all[1].at("iou"), 0.25);
  EXPECT_FALSE(all[1].contains("ari_fg"));
}

TEST(TrainingLog, ASkippedStepIsCounted) {
  StepRecord skipped = record(5);
  skipped.skipped = true;
  skipped.skipped_steps = 2;
  skipped.losses["image"] = std::numeric_limits<double>::quiet_NaN();
  const auto json = nlohmann::json::parse(to_json(skipped).dump());
  EXPECT_EQ(json.at("skipped_steps"), 2);
  EXPECT_TRUE(json.at("losses").at("image").is_null());
  skipped.skipped = false;
  EXPECT_FALSE(to_json(skipped).contains("skipped_steps"));
}

TEST(TrainingLog, GoesOnAfterTheCheckpointsStep) {
  const TempFolder folder;
  {
    TrainingLog log(folder / "log.jsonl", 0);
    for (uint64_t step = 1; step <= 5; ++step) log.add(record(step));
  }
  {
    TrainingLog log(folder / "log.jsonl", 3);
    log.add(record(4));
  }
  const auto all = lines(folder / "log.jsonl");
  ASSERT_EQ(all.size(), 4U);
  for (uint64_t i = 0; i < 4; ++i) EXPECT_EQ(all[i].at("step"), i + 1);
}

TEST(TrainingLog, CutsOffWhatIsNoLineOfIts) {
  const TempFolder folder;
  for (const std::string rest : {"{\"step\":2", "{\"step\":2}", "nonsense\n", "{\"step\":-1}\n", "[]\n"}) {
    write_file(folder / "log.jsonl", "{\"step\":1}\n" + rest);
    TrainingLog log(folder / "log.jsonl", 7);
    log.add(record(8));
    const auto all = lines(folder / "log.jsonl");
    ASSERT_EQ(all.size(), 2U) << rest;
    EXPECT_EQ(all[1].at("step"), 8);
  }
}

TEST(TrainingLog, NamesAFileThatCannotBeWritten) {
  const TempFolder folder;
  test::expect_error([&] { TrainingLog(folder / "absent" / "log.jsonl", 0); }, {"log.jsonl", "written"});
}

}  // namespace
}  // namespace vkopple
