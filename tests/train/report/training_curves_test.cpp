#include "train/report/training_curves.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/training_log.h"

namespace vkopple {
namespace {

using test::TempFolder;

class TrainingCurvesTest : public testing::Test {
 protected:
  std::filesystem::path log() const { return folder_ / "log.jsonl"; }
  TrainingCurves of(const std::string& text) const {
    write_file(log(), text);
    return read_training_curves(log());
  }
  TempFolder folder_;
};

TEST_F(TrainingCurvesTest, ReadsWhatTrainingWrites) {
  {
    TrainingLog writer(log(), 0);
    writer.add({.step = 1, .stage = "depth", .losses = {{"total", 3}}, .data_seconds = 0.25, .seconds = 2});
    writer.add({.step = 2,
                .stage = "all",
                .losses = {{"total", 2}, {"pose", 0.5}},
                .data_seconds = 0.5,
                .seconds = 1,
                .held_out = HeldOutScores{.ari_fg = {}, .iou = 0.25, .depth_r = 0.75}});
  }
  const TrainingCurves curves = read_training_curves(log());
  EXPECT_EQ(curves.steps, 2U);
  ASSERT_EQ(curves.losses.at("total").size(), 2U);
  EXPECT_EQ(curves.losses.at("total")[1].x, 2);
  EXPECT_EQ(curves.losses.at("total")[1].y, 2);
  ASSERT_EQ(curves.losses.at("pose").size(), 1U);
  EXPECT_EQ(curves.seconds[0].y, 2);
  EXPECT_EQ(curves.data_seconds[0].y, 0.25);
  ASSERT_EQ(curves.stages.size(), 2U);
  EXPECT_EQ(curves.stages[1].step, 2U);
  EXPECT_EQ(curves.stages[1].name, "all");
  EXPECT_FALSE(curves.held_out.contains("ari_fg"));
  EXPECT_EQ(curves.held_out.at("depth_r")[0].y, 0.75);
  EXPECT_EQ(curves.held_out.at("iou")[0].x, 2);
}

constexpr const char* kLine = R"({"step":1,"stage":"a","losses":{"total":null},"seconds":1,"data_seconds":0})";

TEST_F(TrainingCurvesTest, LossesThatAreNoNumberAreCounted) {
  const TrainingCurves curves = of(std::string(kLine) + "\n");
  EXPECT_EQ(curves.steps, 1U);
  EXPECT_EQ(curves.not_finite, 1U);
  EXPECT_TRUE(curves.losses.empty());
}

TEST_F(TrainingCurvesTest, ALineThatIsBeingWrittenIsLeftOut) {
  EXPECT_EQ(of(std::string(kLine) + "\n{\"step\":2,").steps, 1U);
  EXPECT_EQ(of("").steps, 0U);
}

TEST_F(TrainingCurvesTest, NamesTheLineThatIsWrong) {
  test::expect_error([&] { of(std::string(kLine) + "\nnonsense\n"); }, {"log.jsonl: line 2"});
  test::expect_error([&] { of("[]\n"); }, {"log.jsonl: line 1"});
  test::expect_error(
      [&] {
        of(R"({"step":1,"stage":"a","losses":{"total":"x"},"seconds":1,"data_seconds":0})"
           "\n");
      },
      {"line 1", "total"});
  test::expect_error([&] { read_training_curves(folder_ / "absent"); }, {"absent"});
}

TEST(Stretches, AreOfEqualLengthButForTheLast) {
  const Curve curve{{1, 4}, {2, 8}, {3, 6}, {4, 1}, {5, 3}};
  const auto three = stretches(curve, 3);
  ASSERT_EQ(three.size(), 3U);
  EXPECT_EQ(three[0].x, 1.5);
  EXPECT_EQ(three[0].low, 4);
  EXPECT_EQ(three[0].high, 8);
  EXPECT_EQ(three[0].mean, 6);
  EXPECT_EQ(three[2].x, 5);
  EXPECT_EQ(three[2].mean, 3);
  EXPECT_EQ(stretches(curve, 100).size(), 5U);
}

}  // namespace
}  // namespace vkopple
