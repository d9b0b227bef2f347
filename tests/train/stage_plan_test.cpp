#include "train/stage_plan.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

constexpr const char* kTwoStages = R"({"training": {"stages": [
    {"name": "first", "steps": 5, "batch": 2},
    {"name": "second", "batch": 1000}]}})";

Config two_stages() { return Config::parse(kTwoStages, "test"); }

TEST(StagePlan, StagesFollowOneAnother) {
  const StagePlan plan(two_stages(), 12);
  ASSERT_EQ(plan.stages().size(), 2U);
  EXPECT_EQ(plan.stages()[0].begin, 0U);
  EXPECT_EQ(plan.stages()[0].end, 5U);
  EXPECT_EQ(plan.stages()[1].begin, 5U);
  EXPECT_EQ(plan.steps(), 12U);
  EXPECT_EQ(plan.stage_of(0), 0U);
  EXPECT_EQ(plan.stage_of(4), 0U);
  EXPECT_EQ(plan.stage_of(5), 1U);
  EXPECT_EQ(plan.stage_of(11), 1U);
  EXPECT_EQ(plan.stage_of(99), 1U);
}

TEST(StagePlan, AShortRunHasTheFirstStageAlone) {
  for (const uint64_t steps : {3U, 5U}) {
    const StagePlan plan(two_stages(), steps);
    ASSERT_EQ(plan.stages().size(), 1U);
    EXPECT_EQ(plan.steps(), steps);
    EXPECT_EQ(plan.stage_of(99), 0U);
  }
}

TEST(StagePlan, AnEndlessStageShowsAsMuchAsTheAuthorsDid) {
  const StagePlan plan(two_stages(), std::nullopt);
  EXPECT_EQ(plan.steps(), 5U + 15'125U);
  EXPECT_EQ(StagePlan(Config::load("full"), std::nullopt).steps(), 756'250U);
}

TEST(StagePlan, NoStepsAreRefused) {
  test::expect_error([] { StagePlan(two_stages(), 0); }, {"--steps"});
}

}  // namespace
}  // namespace vkopple
