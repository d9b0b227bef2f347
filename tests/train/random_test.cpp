#include "train/random.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace vkopple {
namespace {

using Block = std::array<std::uint32_t, 4>;

TEST(Random, PhiloxGivesThePublishedNumbers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kAll = 0xffffffff;
  EXPECT_EQ(philox({kAll, kAll, kAll, kAll}, {kAll, kAll}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
}

TEST(Random, AStreamIsAFunctionOfSeedAndNumber) {
  Random a(1, 2), again(1, 2), other_stream(1, 3), other_seed(2, 2), far_seed(1 + (std::uint64_t{1} << 32), 2);
  int same = 0;
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t x = a.bits();
    EXPECT_EQ(x, again.bits());
    same += (x == other_stream.bits()) + (x == other_seed.bits()) + (x == far_seed.bits());
  }
  EXPECT_EQ(same, 0);
}

TEST(Random, UniformFillsItsRangeEvenly) {
  Random random(7, 0);
  std::vector<int> tenth(10);
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform();
    ASSERT_TRUE(x >= 0 && x < 1);
    ++tenth[static_cast<std::size_t>(x * 10)];
  }
  for (const int count : tenth) EXPECT_NEAR(count, 10000, 500);
}

TEST(Random, BelowReachesEveryValueAndNoMore) {
  Random random(7, 1);
  std::vector<int> seen(5);
  for (int i = 0; i < 5000; ++i) ++seen.at(random.below(5));
  for (const int count : seen) EXPECT_NEAR(count, 1000, 150);
  EXPECT_EQ(random.below(1), 0U);
}

}  // namespace
}  // namespace vkopple
