#include "models/pose_resampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace vkopple {
namespace {

constexpr double kPi = std::numbers::pi;

/// Row number `degrees` + 180 of the table.
std::vector<double> row(const std::vector<float>& rows, size_t bins, int degrees) {
  const auto first = rows.begin() + static_cast<std::ptrdiff_t>(bins) * (degrees + 180);
  return {first, first + static_cast<std::ptrdiff_t>(bins)};
}

/// T K_0, which should be K_a: the definition, for so few bins that K_0 is well-conditioned.
TEST(PoseResamplingTest, IsTheQuotientOfItsDefinition) {
  for (const size_t bins : {1U, 2U, 3U, 8U, 24U, 37U}) {
    const auto rows = resampling_rows(static_cast<int64_t>(bins));
    ASSERT_EQ(rows.size(), 361 * bins);
    const auto density = [&](size_t n, double a) {
      return std::exp(100 * (std::cos(2 * kPi * static_cast<double>(n) / static_cast<double>(bins) + a) - 1));
    };
    for (const int degrees : {-180, -37, 0, 1, 90, 179}) {
      const auto t = row(rows, bins, degrees);
      for (size_t n = 0; n < bins; ++n) {
        double sum = 0;
        for (size_t k = 0; k < bins; ++k) sum += t[k] * density((n + bins - k) % bins, 0);
        EXPECT_NEAR(sum, density(n, degrees * kPi / 180), 1e-6) << bins << " bins, " << degrees << " degrees";
      }
    }
  }
}

/// Bins whose K_0 no double can invert: a smooth function comes out turned.
TEST(PoseResamplingTest, TurnsSmoothFunctionsWithAnyNumberOfBins) {
  for (const size_t bins : {150U, 361U, 720U, 1000U}) {
    const auto rows = resampling_rows(static_cast<int64_t>(bins));
    const auto smooth = [&](double m) {
      const double angle = 2 * kPi * m / static_cast<double>(bins);
      return std::sin(angle) + 0.5 * std::cos(3 * angle + 1);
    };
    for (const int degrees : {-91, 0, 1, 60}) {
      const auto t = row(rows, bins, degrees);
      double largest = 0;
      for (size_t n = 0; n < bins; ++n) {
        double sum = 0;
        for (size_t k = 0; k < bins; ++k) sum += t[(k + bins - n) % bins] * smooth(static_cast<double>(k));
        const double turned = smooth(static_cast<double>(n) - degrees * static_cast<double>(bins) / 360);
        largest = std::max(largest, std::abs(sum - turned));
      }
      EXPECT_LT(largest, 1e-5) << bins << " bins, " << degrees << " degrees";
    }
  }
}

}  // namespace
}  // namespace vkopple
