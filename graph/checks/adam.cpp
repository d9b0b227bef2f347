#include "graph/ops/adam.h"

#include <algorithm>
#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_adam(CheckList& list) {
  const AdamOptions options{.learning_rate = 0.01F, .clip = 0.5F};
  const auto reference = [options](const HostTensors& x) {
    // β as the shader has them, in float; 1 − βᵗ by the recurrence's definition.
    const auto b1 = static_cast<double>(options.beta1);
    const auto b2 = static_cast<double>(options.beta2);
    const auto clip = static_cast<double>(options.clip);
    HostTensor p = x[0];
    HostTensor m = x[2];
    HostTensor v = x[3];
    HostTensor c = x[4];
    c.values[0] = b1 * c.values[0] + (1 - b1);
    c.values[1] = b2 * c.values[1] + (1 - b2);
    for (size_t i = 0; i < p.values.size(); ++i) {
      const double g = std::clamp(x[1].values[i], -clip, clip);
      m.values[i] = b1 * m.values[i] + (1 - b1) * g;
      v.values[i] = b2 * v.values[i] + (1 - b2) * g * g;
      p.values[i] -= static_cast<double>(options.learning_rate) / c.values[0] * m.values[i] /
                     (std::sqrt(v.values[i]) / std::sqrt(c.values[1]) + static_cast<double>(options.epsilon));
    }
    return HostTensors{p, m, v, c};
  };
  for (const int64_t count : {1, 3, 64, 1031})
    for (const bool first_step : {true, false})
      list.push_back({.label = std::to_string(count) + (first_step ? " first step" : " later"),
                      .op = std::make_shared<Adam>(options),
                      .inputs = {row_major({count}), row_major({count}), row_major({count}), row_major({count}),
                                 row_major({2})},
                      .reference = reference,
                      .ranges = {{-1, 1}, {-1, 1}, {-0.1, 0.1}, {1e-4, 0.01}, {0.2, 0.9}},
                      .prepare = [first_step](HostTensors& x) {
                        if (!first_step) return;
                        for (size_t i : {2, 3, 4}) std::fill(x[i].values.begin(), x[i].values.end(), 0.0);
                      }});
}

}  // namespace vkopple
