#include "models/model_check.h"

#include <gtest/gtest.h>

#include "tests/support/test_device.h"

namespace vkopple {
namespace {

class ModelCheckTest : public testing::TestWithParam<StatisticsFrames> {};

TEST_P(ModelCheckTest, BackwardAgreesWithDifferencesOfTheLoss) {
  const auto checks = check_model(test_device(), GetParam());
  ASSERT_EQ(checks.size(), 6U);
  for (const DirectionalCheck& c : checks) {
    EXPECT_TRUE(c.passed()) << c.group << " along " << c.direction << ": " << c.analytic << " against "
                            << c.numeric;
    EXPECT_GT(std::abs(c.analytic), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Frames, ModelCheckTest,
                         testing::Values(StatisticsFrames::kAll, StatisticsFrames::kSecond));

}  // namespace
}  // namespace vkopple
