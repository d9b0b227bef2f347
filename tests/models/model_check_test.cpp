#include "models/model_check.h"

#include <gtest/gtest.h>

#include "tests/support/test_device.h"

namespace vkopple {
namespace {

class ModelCheckTest : public testing::TestWithParam<CheckedModel> {};

TEST_P(ModelCheckTest, BackwardAgreesWithDifferencesOfTheLoss) {
  const auto checks = check_model(test_device(), GetParam().config);
  ASSERT_EQ(checks.size(), GetParam().config.relaxed ? 8U : 6U);
  for (const DirectionalCheck& c : checks) {
    EXPECT_TRUE(c.passed()) << c.group << " along " << c.direction << ": " << c.analytic << " against "
                            << c.numeric;
    EXPECT_GT(std::abs(c.analytic), 0.0);
  }
}

std::string test_name(const testing::TestParamInfo<CheckedModel>& test) {
  std::string name;
  for (const char c : test.param.name) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Models, ModelCheckTest, testing::ValuesIn(checked_models()), test_name);

}  // namespace
}  // namespace vkopple
