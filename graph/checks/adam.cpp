#include "graph/ops/adam.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "graph/checks/check.h"
#include "graph/ops/loss_scale.h"

namespace vkopple {
namespace {

/// The new parameters, m, v and corrections.
HostTensors adam_reference(const HostTensors& x, const AdamOptions& o) {
  HostTensor p = x[0];
  HostTensor m = x[2];
  HostTensor v = x[3];
  HostTensor c = x[4];
  const double factor = x.size() > 6 ? x[6].at(LossScale::kFactor) : 1;
  if (factor == 0) return {p, m, v, c};
  c.at(0) = c.at(0) * o.beta1 + 1 - o.beta1;
  c.at(1) = c.at(1) * o.beta2 + 1 - o.beta2;
  for (size_t i = 0; i < p.values.size(); ++i) {
    const double g = std::clamp(x[1].values[i] * factor, -o.clip, o.clip);
    m.values[i] = o.beta1 * m.values[i] + (1 - o.beta1) * g;
    v.values[i] = o.beta2 * v.values[i] + (1 - o.beta2) * g * g;
    p.values[i] -=
        x[5].at(0) / c.at(0) * m.values[i] / (std::sqrt(v.values[i]) / std::sqrt(c.at(1)) + o.epsilon);
  }
  return {p, m, v, c};
}

/// steps: how many came before; 0 starts with state of zeros, as training does.
CheckCase adam_case(int64_t size, int steps, const AdamOptions& o) {
  const TensorSpec flat = row_major({size});
  return {.label = fmt::format("{} elements after {} steps, clip {}", size, steps, o.clip),
          .op = std::make_shared<Adam>(o),
          .inputs = {flat, flat, flat, flat, row_major({2}), row_major({1})},
          .reference = [=](const HostTensors& x) { return adam_reference(x, o); },
          .ranges = {{-1, 1}, {-3, 3}, {-1, 1}, {0, 1}, {0, 1}, {0.05, 0.2}},
          .prepare =
              [=](HostTensors& x) {
                x[4].values = {1 - std::pow(o.beta1, steps), 1 - std::pow(o.beta2, steps)};
                if (steps > 0) return;
                for (size_t i : {2, 3}) std::fill(x[i].values.begin(), x[i].values.end(), 0.0);
              }};
}

/// With a loss scale whose factor is this. A skipped step's gradient is not finite.
CheckCase scaled_adam_case(int64_t size, const AdamOptions& o, double factor) {
  CheckCase check = adam_case(size, 3, o);
  check.label += fmt::format(", factor {}", factor);
  check.inputs.push_back(row_major({LossScale::kElements}));
  check.prepare = [factor, plain = check.prepare](HostTensors& x) {
    plain(x);
    x[6].at(LossScale::kFactor) = factor;
    if (factor == 0) x[1].values[0] = std::numeric_limits<double>::infinity();
    if (factor == 0) x[1].values[1] = std::numeric_limits<double>::quiet_NaN();
  };
  return check;
}

}  // namespace

void check_adam(CheckList& list) {
  list.push_back(adam_case(4, 0, {}));
  list.push_back(adam_case(64, 0, {.clip = 1}));
  list.push_back(adam_case(1036, 3, {.clip = 2.5}));
  list.push_back(adam_case(260, 1000, {.beta1 = 0.5, .beta2 = 0.9, .epsilon = 0.1}));
  list.push_back(scaled_adam_case(1036, {.clip = 0.5}, 0.25));
  list.push_back(scaled_adam_case(1036, {}, 0));
}

}  // namespace vkopple
