#include "train/count_progress.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

TEST(CountProgress, ALineTellsPaceAndTimeLeft) {
  EXPECT_EQ(count_line(30, 90, "scenes", 60), "30/90 scenes  0.5 scenes/s  2:00 left");
  EXPECT_EQ(count_line(90, 90, "scenes", 60), "90/90 scenes  1.5 scenes/s  0:00 left");
  EXPECT_EQ(count_line(0, 90, "scenes", 60), "0/90 scenes");
  EXPECT_EQ(count_line(90, 90, "scenes", 0), "90/90 scenes");
  EXPECT_EQ(count_line(90, 0, "scenes", 60), "90 scenes") << "of how many is unknown";
}

}  // namespace
}  // namespace vkopple
