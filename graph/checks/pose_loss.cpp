#include "graph/ops/pose_loss.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

/// Of one bin: p log(p / r), from logarithms.
double kl(double log_p, double log_r) { return std::exp(log_p) * (log_p - log_r); }

HostTensors reference(const HostTensors& x, PoseDivergence divergence) {
  const Shape& shape = x[0].shape;
  HostTensor y({1});
  for (int64_t b = 0; b < shape[0]; ++b)
    for (int64_t k = 0; k < shape[1]; ++k)
      for (int64_t n = 0; n < shape[2]; ++n) {
        const double p = x[0].at(b, k, n);
        const double r = x[1].at(b, k, n);
        const double mean = std::log((std::exp(p) + std::exp(r)) / 2);
        const double term = divergence == PoseDivergence::kKl ? kl(p, r) + kl(r, p) : kl(p, mean) + kl(r, mean);
        y.values[0] += x[2].at(b, k) * 0.5 * term / static_cast<double>(shape[0]);
      }
  return {y};
}

/// Makes logarithms of distributions of the first two inputs.
void normalise(HostTensors& x) {
  for (size_t input : {size_t{0}, size_t{1}}) {
    const auto bins = static_cast<size_t>(x[input].shape[2]);
    auto& values = x[input].values;
    for (size_t first = 0; first < values.size(); first += bins) {
      double sum = 0;
      for (size_t n = 0; n < bins; ++n) sum += std::exp(values[first + n]);
      for (size_t n = 0; n < bins; ++n) values[first + n] -= std::log(sum);
    }
  }
}

}  // namespace

void check_pose_loss(CheckList& list) {
  for (PoseDivergence divergence : {PoseDivergence::kKl, PoseDivergence::kJs})
    for (const Shape& shape : {Shape{1, 1, 2}, Shape{2, 3, 120}, Shape{3, 1, 7}, Shape{5, 2, 33}})
      list.push_back(
          {.label = fmt::format("{} {}", shape.text(), divergence == PoseDivergence::kKl ? "KL" : "JS"),
           .op = std::make_shared<PoseLoss>(divergence),
           .inputs = {row_major(shape), row_major(shape), row_major({shape[0], shape[1]})},
           .reference = [divergence](const HostTensors& x) { return reference(x, divergence); },
           .ranges = {{-4, 4}, {-4, 4}, {0, 1}},
           .prepare = normalise});
}

}  // namespace vkopple
