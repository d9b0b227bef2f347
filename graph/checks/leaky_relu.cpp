#include "graph/ops/leaky_relu.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_leaky_relu(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y = x[0];
    for (double& v : y.values) v = v > 0 ? v : static_cast<double>(0.1F) * v;
    return HostTensors{y};
  };
  // Finite differences straddle the kink at 0 where an input is closer to it than their step.
  const auto off_the_kink = [](HostTensors& x) {
    for (double& v : x[0].values) v += std::copysign(0.01, v);
  };
  for (const TensorSpec& spec : {row_major({1}), row_major({3, 5, 7}), row_major({1031}),
                                 channels4({2, 3, 5, 7}), channels4({1, 16, 9, 8}), channels4({2, 7, 18, 19})})
    list.push_back({.label = spec.shape.text(),
                    .op = std::make_shared<LeakyRelu>(0.1F),
                    .inputs = {spec},
                    .reference = reference,
                    .prepare = off_the_kink});
}

}  // namespace vkopple
