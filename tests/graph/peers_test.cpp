#include "graph/parallel/peers.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/threaded_peers.h"

namespace vkopple {
namespace {

TEST(Peers, GatherKeepsTheOrderOfRanks) {
  test::run_together(3, [](Peers& peers) {
    const auto own = static_cast<float>(10 * peers.rank());
    EXPECT_EQ(peers.gather(std::array{own, own + 1}), (std::vector<float>{0, 1, 10, 11, 20, 21}));
    EXPECT_GT(peers.seconds(), 0);
  });
}

TEST(Peers, AverageOfAnyLengthIsTheSameEverywhere) {
  for (const size_t length : {1U, 2U, 3U, 7U, 64U})
    test::run_together(3, [length](Peers& peers) {
      std::vector<float> values;
      for (size_t i = 0; i < length; ++i)
        values.push_back(static_cast<float>(i) + 3 * static_cast<float>(peers.rank()));
      peers.average(values);
      for (size_t i = 0; i < length; ++i) EXPECT_EQ(values[i], static_cast<float>(i) + 3);
    });
}

/// In float the sum of the first two would lose the third.
TEST(Peers, AverageAddsInDouble) {
  test::run_together(3, [](Peers& peers) {
    constexpr std::array<float, 3> kGiven{1e8F, 1.0F, -1e8F};
    std::vector<float> values{kGiven[static_cast<size_t>(peers.rank())]};
    peers.average(values);
    EXPECT_EQ(values[0], 1.0F / 3);
  });
}

TEST(Peers, NobodyIsNotSeveral) { EXPECT_FALSE(several(nullptr)); }

}  // namespace
}  // namespace vkopple
