#include "train/natural_order.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace vkopple {
namespace {

TEST(NaturalOrder, NumbersCountAsNumbers) {
  const std::vector<std::string> ordered{"",
                                         "7",
                                         "10",
                                         "frame",
                                         "frame1.png",
                                         "frame2",
                                         "frame2.png",
                                         "frame10.png",
                                         "frame99999999999999999999999.png",
                                         "frame100000000000000000000000.png",
                                         "frames",
                                         "take1-9",
                                         "take1-10",
                                         "take2-1",
                                         "z",
                                         "\xc3\xa4"};
  for (size_t i = 0; i < ordered.size(); ++i)
    for (size_t j = 0; j < ordered.size(); ++j)
      EXPECT_EQ(natural_less(ordered[i], ordered[j]), i < j) << ordered[i] << " " << ordered[j];
}

TEST(NaturalOrder, ZerosBeforeNumbersDecideLast) {
  EXPECT_TRUE(natural_less("a01b", "a1c"));
  EXPECT_TRUE(natural_less("a1b", "a01c"));
  EXPECT_NE(natural_less("a01", "a1"), natural_less("a1", "a01")) << "or they would be the same";
  EXPECT_TRUE(natural_less("a00", "a1"));
  EXPECT_TRUE(natural_less("a000", "a0b"));
}

}  // namespace
}  // namespace vkopple
