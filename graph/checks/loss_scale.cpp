#include "graph/ops/loss_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors loss_scale_reference(const HostTensors& x, const LossScaleOptions& o) {
  HostTensor state = x[0];
  HostTensor found(x[1].shape);
  for (size_t i = 2; i < x.size(); ++i)
    for (double g : x[i].values)
      if (!std::isfinite(g)) found.at(0) = 1;
  const double scale = x[0].at(0);
  if (found.at(0) != 0) {
    state.values = {std::max(scale / 2, static_cast<double>(o.smallest)), 0, x[0].at(2) + 1, 0};
  } else {
    const bool doubles = x[0].at(1) + 1 == static_cast<double>(o.interval);
    state.values = {doubles ? std::min(scale * 2, static_cast<double>(o.largest)) : scale,
                    doubles ? 0 : x[0].at(1) + 1, x[0].at(2), 1 / scale};
  }
  return {state, found};
}

/// bad: what element `at` of the last gradient is set to; 0 leaves it.
CheckCase loss_scale_case(double scale, double good, const std::vector<int64_t>& sizes, double bad, size_t at) {
  const LossScaleOptions options{.smallest = 4, .largest = 65536, .interval = 10};
  std::vector<TensorSpec> inputs{row_major({LossScale::kElements}), unsigned_ints({1})};
  for (int64_t size : sizes) inputs.push_back(row_major({size}));
  return {.label = fmt::format("scale {}, {} good steps, {} gradients, {} at {}", scale, good, sizes.size(),
                               bad, at),
          .op = std::make_shared<LossScale>(options),
          .inputs = inputs,
          .reference = [=](const HostTensors& x) { return loss_scale_reference(x, options); },
          .prepare =
              [=](HostTensors& x) {
                x[0].values = {scale, good, 5, 0.25};
                x[1].values = {7};  // of the step before
                for (double& g : x[2].values) g *= 3e38;
                if (bad != 0) x.back().values[at] = bad;
              }};
}

}  // namespace

void check_loss_scale(CheckList& list) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  list.push_back(loss_scale_case(32768, 3, {4, 1036}, 0, 0));
  list.push_back(loss_scale_case(32768, 9, {68}, 0, 0));
  list.push_back(loss_scale_case(65536, 9, {68}, 0, 0));
  list.push_back(loss_scale_case(32768, 9, {4, 1036}, kInfinity, 1035));
  list.push_back(loss_scale_case(8, 3, {260, 4, 8}, -kInfinity, 0));
  list.push_back(loss_scale_case(4, 3, {20000}, std::numeric_limits<double>::quiet_NaN(), 19997));
}

}  // namespace vkopple
