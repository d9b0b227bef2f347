#include "graph/plan.h"

#include <gtest/gtest.h>

#include <random>

namespace vkopple {
namespace {

TEST(PlanTest, ReusesMemoryWhoseLifeIsOver) {
  const std::vector<MemoryRequest> requests{{1000, 0, 1}, {1000, 2, 3}, {1000, 4, 5}};
  EXPECT_EQ(plan_memory(requests, 1 << 20, 256).total_bytes(), 1024U);
}

TEST(PlanTest, NeverOverlapsInTimeAndSpace) {
  std::mt19937 random(3);
  std::vector<MemoryRequest> requests;
  for (int i = 0; i < 300; ++i) {
    const auto first = static_cast<int64_t>(random() % 100);
    requests.push_back({1 + random() % 5000, first, first + static_cast<int64_t>(random() % 20)});
  }
  const MemoryPlan plan = plan_memory(requests, 20000, 64);
  for (size_t i = 0; i < requests.size(); ++i) {
    const auto& p = plan.placements[i];
    EXPECT_EQ(p.offset % 64, 0U);
    EXPECT_LE(p.offset + requests[i].bytes, plan.block_bytes[p.block]);
    EXPECT_LE(plan.block_bytes[p.block], 20000U);
    for (size_t j = 0; j < i; ++j) {
      const auto& q = plan.placements[j];
      const bool together = requests[i].first <= requests[j].last && requests[j].first <= requests[i].last;
      const bool touch = p.block == q.block && p.offset < q.offset + requests[j].bytes &&
                         q.offset < p.offset + requests[i].bytes;
      EXPECT_FALSE(together && touch) << i << " and " << j;
    }
  }
}

TEST(PlanTest, ARequestBeyondTheLimitGetsItsOwnBlock) {
  const std::vector<MemoryRequest> requests{{100000, 0, 1}, {100, 0, 1}};
  const MemoryPlan plan = plan_memory(requests, 4096, 256);
  EXPECT_NE(plan.placements[0].block, plan.placements[1].block);
}

}  // namespace
}  // namespace vkopple
