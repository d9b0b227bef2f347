#include "train/tensorboard/training_board.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/support/events.h"
#include "tests/support/temp_folder.h"

namespace vkopple {
namespace {

using test::TempFolder;
using Points = std::map<std::string, std::map<int64_t, float>>;  ///< by tag and step

class TrainingBoardTest : public testing::Test {
 protected:
  static StepRecord record(uint64_t step, double loss, const std::string& stage = "all") {
    return {.step = step,
            .stage = stage,
            .batch = 4,
            .losses = {{"total", loss}},
            .data_seconds = 0.5,
            .seconds = 2,
            .learning_rate = 0.25};
  }

  Points points() const {
    Points points;
    for (const auto& event : test::read_events(test::event_files(folder_.path()).at(0)))
      for (const auto& value : event.summary().values()) points[value.tag()][event.step()] = value.scalar();
    return points;
  }

  TempFolder folder_;
  TrainingBoard board_{folder_.path(), 0};
};

TEST_F(TrainingBoardTest, APointIsTheMeanOfTenSteps) {
  for (uint64_t step = 1; step <= 20; ++step) board_.add(record(step, static_cast<double>(step)));
  const Points all = points();
  EXPECT_EQ(all.at("loss/total"), (std::map<int64_t, float>{{10, 5.5F}, {20, 15.5F}}));
  EXPECT_EQ(all.at("learning_rate"), (std::map<int64_t, float>{{10, 0.25F}, {20, 0.25F}}));
  EXPECT_EQ(all.at("speed/triplets_per_second").at(10), 2.0F);
  EXPECT_EQ(all.at("speed/data_share").at(20), 0.25F);
}

TEST_F(TrainingBoardTest, StagesAreNotMixedAndTheRestIsFlushed) {
  board_.add(record(1, 3, "depth"));
  board_.add(record(2, 5, "depth"));
  board_.add(record(3, 7));
  board_.flush();
  board_.flush();  // nothing is left
  EXPECT_EQ(points().at("loss/total"), (std::map<int64_t, float>{{2, 4.0F}, {3, 7.0F}}));
}

TEST_F(TrainingBoardTest, SkippedStepsAreCountedAndLeftOutOfMeans) {
  for (uint64_t step = 1; step <= 20; ++step) {
    StepRecord one = record(step, 2);
    one.skipped = step > 16;
    if (one.skipped) one.losses["total"] = std::numeric_limits<double>::quiet_NaN();
    one.skipped_steps = step > 16 ? step - 16 : 0;
    board_.add(one);
  }
  for (uint64_t step = 21; step <= 30; ++step) {
    StepRecord one = record(step, 0);
    one.skipped = true;
    one.skipped_steps = step - 16;
    board_.add(one);
  }
  const Points all = points();
  EXPECT_EQ(all.at("loss/total"), (std::map<int64_t, float>{{10, 2.0F}, {20, 2.0F}}));
  EXPECT_EQ(all.at("skipped_steps"), (std::map<int64_t, float>{{20, 4.0F}, {30, 14.0F}}));
}

TEST_F(TrainingBoardTest, WhatWasMeasuredIsThereAtOnce) {
  StepRecord measured = record(1, 3);
  measured.held_out = {.ari_fg = 0.5, .iou = {}, .depth_r = 0.25};
  measured.norms = {{"depth", {.weights = 8, .gradient = 2}}};
  board_.add(measured);
  const Points all = points();
  EXPECT_EQ(all.at("held_out/ari_fg").at(1), 0.5F);
  EXPECT_EQ(all.at("held_out/depth_r").at(1), 0.25F);
  EXPECT_FALSE(all.contains("held_out/iou"));
  EXPECT_EQ(all.at("weight_norm/depth").at(1), 8.0F);
  EXPECT_EQ(all.at("gradient_norm/depth").at(1), 2.0F);
  EXPECT_FALSE(all.contains("loss/total"));
}

TEST_F(TrainingBoardTest, NoRowsNoPicture) {
  board_.show(1, {});
  EXPECT_TRUE(points().empty());
  board_.show(2, {{RgbImage(4, 4), RgbImage(4, 4)}});
  EXPECT_TRUE(points().contains("held_out"));
}

}  // namespace
}  // namespace vkopple
