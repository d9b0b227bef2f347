#include "graph/ops/rotation_posterior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

/// As §4 says it: the joint distribution over both yaws, normalised, summed along its diagonals.
HostTensors posterior(const HostTensor& p1, const HostTensor& p2, double kappa) {
  HostTensor log_g(p1.shape);
  HostTensor direction({p1.shape[0], p1.shape[1], 2});
  const int64_t bins = p1.shape[2];
  const auto angle = [bins](int64_t bin) {
    return 2 * std::numbers::pi * static_cast<double>(bin) / static_cast<double>(bins);
  };
  std::vector<double> prior;  // of n − m, counted from −(bins − 1)
  for (int64_t turn = 1 - bins; turn < bins; ++turn) prior.push_back(std::exp(kappa * std::cos(angle(turn))));
  for (int64_t b = 0; b < p1.shape[0]; ++b)
    for (int64_t k = 0; k < p1.shape[1]; ++k) {
      std::vector<double> g(static_cast<size_t>(bins), 0.0);
      double total = 0;
      for (int64_t m = 0; m < bins; ++m)
        for (int64_t n = 0; n < bins; ++n) {
          const double joint =
              std::exp(p1.at(b, k, m) + p2.at(b, k, n)) * prior[static_cast<size_t>(n - m + bins - 1)];
          g[static_cast<size_t>((n - m + bins) % bins)] += joint;
          total += joint;
        }
      double x = 1e-8;
      double y = 0;
      for (int64_t turn = 0; turn < bins; ++turn) {
        const double share = g[static_cast<size_t>(turn)] / total;
        log_g.at(b, k, turn) = std::log(share);
        x += share * std::cos(angle(turn));
        y += share * std::sin(angle(turn));
      }
      direction.at(b, k, 0) = std::clamp(x / std::hypot(x, y), -1.0, 1.0);
      direction.at(b, k, 1) = std::clamp(y / std::hypot(x, y), -1.0, 1.0);
    }
  return {log_g, direction};
}

}  // namespace

void check_rotation_posterior(CheckList& list) {
  struct Case {
    Shape shape;
    float kappa;
    double range;
  };
  for (const Case& c : {Case{{1, 1, 1}, 0.2F, 1}, Case{{2, 3, 7}, 0.2F, 8}, Case{{1, 1, 120}, 0.2F, 10},
                        Case{{1, 2, 37}, 3, 4}, Case{{2, 1, 8}, 0, 20}})
    list.push_back({.label = fmt::format("{}, kappa {}, to {}", c.shape.text(), c.kappa, -c.range),
                    .op = std::make_shared<RotationPosterior>(c.kappa),
                    .inputs = {row_major(c.shape), row_major(c.shape)},
                    .reference = [kappa = static_cast<double>(c.kappa)](
                                     const HostTensors& x) { return posterior(x[0], x[1], kappa); },
                    .ranges = {{-c.range, 0}, {-c.range, 0}}});
}

}  // namespace vkopple
