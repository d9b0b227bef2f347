#include "train/data/triplets.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

TEST(Triplets, EveryEvenStride) {
  const std::vector<std::array<int, 3>> expected{{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 5}, {4, 5, 6},
                                                 {0, 2, 4}, {1, 3, 5}, {2, 4, 6}, {0, 3, 6}};
  EXPECT_EQ(strided_triplets(7), expected);
  EXPECT_EQ(strided_triplets(3).size(), 1U);
  EXPECT_TRUE(strided_triplets(2).empty());
}

TEST(Triplets, ReverseSwapsOneTripletsOuterFrames) {
  TripletBatch b;
  b.batch = 2, b.height = 1, b.width = 2;
  for (std::size_t frame = 0; frame < 3; ++frame) {
    for (int i = 0; i < 12; ++i)
      b.images[frame].push_back(static_cast<float>(100 * frame) + static_cast<float>(i));
    for (int i = 0; i < 12; ++i)
      b.poses[frame].push_back(static_cast<float>(-100 * static_cast<int>(frame) - i));
  }
  const TripletBatch before = b;
  b.reverse(1);
  EXPECT_EQ(b.images[1], before.images[1]);
  for (std::size_t i = 0; i < 12; ++i) {
    const std::size_t from = i < 6 ? 0 : 2;
    EXPECT_EQ(b.images[0][i], before.images[from][i]);
    EXPECT_EQ(b.images[2][i], before.images[2 - from][i]);
    EXPECT_EQ(b.poses[0][i], before.poses[from][i]);
    EXPECT_EQ(b.poses[2][i], before.poses[2 - from][i]);
  }
}

}  // namespace
}  // namespace vkopple
