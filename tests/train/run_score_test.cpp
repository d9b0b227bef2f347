#include "train/run_score.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

TEST(RunScore, IsOfObjectsOnceTheyAreLearned) {
  const HeldOutScores depth{.ari_fg = {}, .iou = {}, .depth_r = 0.9};
  const HeldOutScores objects{.ari_fg = 0.25, .iou = 0.5, .depth_r = 0.1};
  EXPECT_EQ(run_score(depth), (RunScore{false, 0.9}));
  EXPECT_EQ(run_score(objects), (RunScore{true, 0.75}));
  EXPECT_EQ(run_score({}), std::nullopt);
  EXPECT_LT(*run_score(depth), *run_score(objects));
  EXPECT_LT((RunScore{true, 0.5}), (RunScore{true, 0.75}));
}

TEST(RunScore, IsTheSameReadBack) {
  for (const RunScore& score : {RunScore{false, -0.1}, RunScore{true, 1.0 / 3}, RunScore{true, 2}})
    EXPECT_EQ(parse_run_score(to_text(score)), score) << to_text(score);
  EXPECT_EQ(to_text({true, 1.25}), "iou+ari_fg 1.25");
  for (const char* text : {"", "depth_r", "depth_r ", "depth_r x", "depth_r 1 ", "depth_r nan", "other 1"})
    EXPECT_EQ(parse_run_score(text), std::nullopt) << text;
}

}  // namespace
}  // namespace vkopple
