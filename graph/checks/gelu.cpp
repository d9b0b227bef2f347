#include "graph/ops/gelu.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "graph/checks/check.h"

namespace vkopple {

void check_gelu(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y = x[0];
    for (double& v : y.values) v *= 0.5 * std::erfc(-v / std::numbers::sqrt2);
    return HostTensors{y};
  };
  // Up to 9: beyond 6 the tails are 0 and 1 in float32, and between them the formula changes at ±sqrt(2).
  for (const TensorSpec& spec : {row_major({1}), row_major({3, 5, 7}), row_major({1031}),
                                 channels4({2, 3, 5, 7}), channels4({1, 16, 9, 8}), channels4({2, 7, 18, 19})})
    for (const double range : {2.0, 9.0})
      list.push_back({.label = fmt::format("{} up to {}", spec.shape.text(), range),
                      .op = std::make_shared<Gelu>(),
                      .inputs = {spec},
                      .reference = reference,
                      .ranges = {{-range, range}}});
}

}  // namespace vkopple
