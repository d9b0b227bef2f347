#include "models/authors_cost.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

// As tools/reference/time_step.py counts the reference's step, which runs as the authors do (docs/model.md
// §12).
TEST(AuthorsCost, IsWhatTheReferenceCounts) { EXPECT_NEAR(authors_flop(ModelConfig{}) * 1e-9, 92.7, 0.05); }

TEST(AuthorsCost, DoesNotDependOnHowItIsRunHere) {
  ModelConfig second;
  second.statistics_frames = StatisticsFrames::kSecond;
  EXPECT_EQ(authors_flop(second), authors_flop(ModelConfig{}));
}

}  // namespace
}  // namespace vkopple
