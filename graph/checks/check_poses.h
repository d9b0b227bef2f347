#pragma once

#include <cmath>

#include "graph/checks/check.h"
#include "graph/ops/pose_loss.h"

namespace vkopple {

/// Of one bin, from logarithms p and r: its part of the divergence of two distributions.
inline double bin_divergence(double p, double r, PoseDivergence divergence) {
  const auto kl = [](double a, double b) { return std::exp(a) * (a - b); };
  if (divergence == PoseDivergence::kKl) return 0.5 * (kl(p, r) + kl(r, p));
  const double mean = std::log((std::exp(p) + std::exp(r)) / 2);
  return 0.5 * (kl(p, mean) + kl(r, mean));
}

/// Makes a tensor (…, bins) one of logarithms of distributions.
inline void normalise_poses(HostTensor& x) {
  const auto bins = static_cast<size_t>(x.shape.back(0));
  for (size_t first = 0; first < x.values.size(); first += bins) {
    double sum = 0;
    for (size_t n = 0; n < bins; ++n) sum += std::exp(x.values[first + n]);
    for (size_t n = 0; n < bins; ++n) x.values[first + n] -= std::log(sum);
  }
}

}  // namespace vkopple
