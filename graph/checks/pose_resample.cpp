#include "graph/ops/pose_resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensor resampled(const HostTensor& log_p, const HostTensor& table, const HostTensor& index) {
  HostTensor y(log_p.shape);
  const int64_t bins = log_p.shape[2];
  for (int64_t b = 0; b < log_p.shape[0]; ++b)
    for (int64_t k = 0; k < log_p.shape[1]; ++k) {
      const int64_t row = std::min(static_cast<int64_t>(index.at(b)), table.shape[0] - 1);
      double largest = -1e300;
      for (int64_t m = 0; m < bins; ++m) {
        for (int64_t n = 0; n < bins; ++n)
          y.at(b, k, m) += table.at(row, (n - m + bins) % bins) * log_p.at(b, k, n);
        largest = std::max(largest, y.at(b, k, m));
      }
      double sum = 0;
      for (int64_t m = 0; m < bins; ++m) sum += std::exp(y.at(b, k, m) - largest);
      for (int64_t m = 0; m < bins; ++m) y.at(b, k, m) -= largest + std::log(sum);
    }
  return y;
}

struct Case {
  Shape pose;
  int64_t rows;
  double cancel;  ///< size of alternating entries that cancel where log p is smooth
};

/// Turns the drawn numbers into small rows (the softmax must not saturate) with large alternating parts, smooth
/// log p, and indices. What alternates cancels where bins are even.
void prepare(const Case& c, HostTensors& x) {
  const int64_t bins = c.pose[2];
  for (int64_t a = 0; a < c.rows; ++a)
    for (int64_t n = 0; n < bins; ++n)
      x[1].at(a, n) = 2 * x[1].at(a, n) / static_cast<double>(bins) + (n % 2 == 0 ? 1 : -1) * c.cancel;
  if (c.cancel > 0)
    for (int64_t b = 0; b < c.pose[0]; ++b)
      for (int64_t k = 0; k < c.pose[1]; ++k)
        for (int64_t n = 0; n < bins; ++n)
          x[0].at(b, k, n) =
              -4 + 0.5 * std::cos(6.2831853 * static_cast<double>(n / 2) / 60) + 0.00002 * x[0].at(b, k, n);
  for (double& index : x[2].values) index = std::floor(index);
  x[2].values[0] = static_cast<double>(c.rows) + 5;  // clamped
}

}  // namespace

void check_pose_resample(CheckList& list) {
  for (const Case& c : {Case{{1, 1, 1}, 1, 0}, Case{{4, 3, 7}, 361, 0}, Case{{2, 2, 120}, 3, 15000},
                        Case{{3, 8, 14}, 5, 1000}, Case{{2, 3, 361}, 4, 0}})
    list.push_back({.label = fmt::format("{} by {} rows, cancelling {}", c.pose.text(), c.rows, c.cancel),
                    .op = std::make_shared<PoseResample>(),
                    .inputs = {row_major(c.pose), row_major({c.rows, c.pose[2]}), unsigned_ints({c.pose[0]})},
                    .reference = [](const HostTensors& x) { return HostTensors{resampled(x[0], x[1], x[2])}; },
                    .ranges = {{-8, 0}, {-1, 1}, {0, static_cast<double>(c.rows)}},
                    .prepare = [c](HostTensors& x) { prepare(c, x); }});
}

}  // namespace vkopple
