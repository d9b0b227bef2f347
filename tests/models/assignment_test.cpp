#include "models/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "tests/support/expect_error.h"
#include "train/random.h"

namespace vkopple {
namespace {

double total(const std::vector<double>& costs, const std::vector<size_t>& chosen, size_t columns) {
  double sum = 0;
  for (size_t row = 0; row < chosen.size(); ++row) sum += costs[row * columns + chosen[row]];
  return sum;
}

/// By trying all orders of the columns.
double least(const std::vector<double>& costs, size_t rows, size_t columns) {
  std::vector<size_t> order(columns);
  std::iota(order.begin(), order.end(), 0);
  double best = 1e300;
  do {
    best = std::min(best,
                    total(costs, {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(rows)}, columns));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(Assignment, TheNearestOfEachIsNotTheBest) {
  // Row 0 is nearest to column 0, but row 1 has nothing else.
  EXPECT_EQ(cheapest_assignment(std::vector<double>{1, 2, 1.5, 9}, 2, 2), (std::vector<size_t>{1, 0}));
  EXPECT_EQ(cheapest_assignment(std::vector<double>{1, 2, 1.5, 2.1}, 2, 2), (std::vector<size_t>{0, 1}));
}

TEST(Assignment, IsTheCheapestOfAll) {
  for (size_t rows = 1; rows <= 5; ++rows)
    for (size_t columns = rows; columns <= 7; ++columns)
      for (uint64_t trial = 0; trial < 10; ++trial) {
        Random random(trial, 100 * rows + columns);
        std::vector<double> costs(rows * columns);
        for (double& cost : costs) cost = random.uniform() - (trial % 2 == 0 ? 0 : 0.5);
        const auto chosen = cheapest_assignment(costs, rows, columns);
        ASSERT_EQ(std::set<size_t>(chosen.begin(), chosen.end()).size(), rows);
        EXPECT_NEAR(total(costs, chosen, columns), least(costs, rows, columns), 1e-12)
            << rows << " rows, " << columns << " columns, trial " << trial;
      }
}

TEST(Assignment, OfNothing) { EXPECT_TRUE(cheapest_assignment({}, 0, 3).empty()); }

TEST(Assignment, RefusesTooFewColumnsOrCosts) {
  test::expect_error([] { cheapest_assignment(std::vector<double>{1, 2}, 2, 1); }, {"columns"});
  test::expect_error([] { cheapest_assignment(std::vector<double>{1, 2}, 1, 3); }, {"cost"});
}

}  // namespace
}  // namespace vkopple
