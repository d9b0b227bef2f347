#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "graph/executor.h"
#include "graph/ops/dropout.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

constexpr int64_t kElements = 1 << 18;

/// Dropout of ones: 0 where dropped, 1 / (1 − rate) where kept.
class Masks {
 public:
  Masks(float rate, uint32_t stream) {
    const Value x = graph_.input("x", row_major({kElements}));
    random_ = graph_.input("random", unsigned_ints({2}));
    graph_.keep("y", dropout(x, random_, rate, stream));
    executor_ = std::make_unique<Executor>(test_device(), graph_);
    executor_->write(x, std::vector<float>(static_cast<size_t>(kElements), 1.0F));
  }
  std::vector<float> draw(uint32_t seed, uint32_t step) {
    executor_->write_words(random_, std::vector<uint32_t>{seed, step});
    executor_->forward();
    return executor_->read(graph_.find("y"));
  }

 private:
  Graph graph_;
  Value random_;
  std::unique_ptr<Executor> executor_;
};

double kept_fraction(const std::vector<float>& y) {
  double kept = 0;
  for (float v : y) kept += v != 0 ? 1 : 0;
  return kept / static_cast<double>(y.size());
}

/// Standard deviations between the number of elements that both drop and what independence predicts.
double shared_drops(const std::vector<float>& a, const std::vector<float>& b, size_t shift, double rate) {
  const size_t count = a.size() - shift;
  double both = 0;
  for (size_t i = 0; i < count; ++i) both += a[i] == 0 && b[i + shift] == 0 ? 1 : 0;
  const double p = rate * rate;
  const auto n = static_cast<double>(count);
  return std::abs(both - n * p) / std::sqrt(n * p * (1 - p));
}

TEST(DropoutStatisticsTest, KeepsTheAskedFractionAndScalesIt) {
  for (const float rate : {0.5F, 0.05F, 0.0005F}) {
    const auto y = Masks(rate, 3).draw(1, 0);
    const double keep = 1 - static_cast<double>(rate);
    EXPECT_NEAR(kept_fraction(y), keep, 4 * std::sqrt(keep * (1 - keep) / kElements)) << rate;
    for (float v : y)
      if (v != 0) {
        ASSERT_FLOAT_EQ(v, static_cast<float>(1 / keep));
      }
  }
}

TEST(DropoutStatisticsTest, StepsSeedsAndStreamsAreIndependent) {
  constexpr double kRate = 0.3;
  Masks first(static_cast<float>(kRate), 0);
  Masks second(static_cast<float>(kRate), 1);
  const auto base = first.draw(1, 0);
  EXPECT_EQ(first.draw(1, 0), base) << "the same numbers must give the same mask";
  EXPECT_LT(shared_drops(base, first.draw(1, 1), 0, kRate), 4) << "next step";
  EXPECT_LT(shared_drops(base, first.draw(2, 0), 0, kRate), 4) << "next seed";
  EXPECT_LT(shared_drops(base, second.draw(1, 0), 0, kRate), 4) << "next stream";
}

TEST(DropoutStatisticsTest, NeighboursAreIndependent) {
  constexpr double kRate = 0.3;
  const auto y = Masks(static_cast<float>(kRate), 0).draw(5, 9);
  for (size_t shift : {1, 2, 3, 4, 8, 32, 64, 128, 4096, 16384})
    EXPECT_LT(shared_drops(y, y, shift, kRate), 4.5) << "shift " << shift;
}

}  // namespace
}  // namespace vkopple
