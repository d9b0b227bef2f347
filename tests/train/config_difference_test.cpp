#include "train/config_difference.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

Config parsed(const char* json) { return Config::parse(json, "test"); }

TEST(ConfigDifference, EqualOnesHaveNone) {
  EXPECT_FALSE(first_difference(Config::load("small"), Config::load("small")));
}

TEST(ConfigDifference, NamesTheFirstKeyWithBothValues) {
  const auto found = first_difference(parsed(R"({"model": {"slots": 3}, "training": {"batch": 4}})"),
                                      parsed(R"({"model": {"slots": 4}, "training": {"batch": 5}})"));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->key, "model.slots");
  EXPECT_EQ(found->first, "3");
  EXPECT_EQ(found->second, "4");
}

TEST(ConfigDifference, LooksIntoLists) {
  const auto found = first_difference(
      parsed(R"({"training": {"stages": [{"name": "a", "steps": 2}, {"name": "b"}]}})"),
      parsed(R"({"training": {"stages": [{"name": "a", "steps": 2}, {"name": "b", "batch": 7}]}})"));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->key, "training.stages[1].batch");
  EXPECT_EQ(found->second, "7");
}

TEST(ConfigDifference, KnowsLongerListsAndAbsentKeys) {
  const auto longer = first_difference(parsed(R"({"training": {"stages": [{"name": "a"}]}})"), parsed("{}"));
  ASSERT_TRUE(longer);
  EXPECT_EQ(longer->key, "training.stages");
  const auto absent = first_difference(parsed(R"({"training": {"stages": [{"name": "a"}]}})"),
                                       parsed(R"({"training": {"stages": [{"name": "a", "steps": 3}]}})"));
  ASSERT_TRUE(absent);
  EXPECT_EQ(absent->key, "training.stages[0].steps");
  EXPECT_EQ(absent->first, "absent");
}

}  // namespace
}  // namespace vkopple
