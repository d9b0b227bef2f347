#include "graph/ops/weighted_sum.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_weighted_sum(CheckList& list) {
  for (const std::vector<float>& weights :
       {std::vector<float>{2.5F}, {1, -0.5F, 3}, {1, 2, -3, 4, 5, -6, 7, 8}}) {
    const auto reference = [weights](const HostTensors& x) {
      HostTensor y({1});
      for (size_t i = 0; i < weights.size(); ++i)
        y.values[0] += static_cast<double>(weights[i]) * x[i].values[0];
      return HostTensors{y};
    };
    list.push_back({.label = fmt::format("{} inputs", weights.size()),
                    .op = std::make_shared<WeightedSum>(weights),
                    .inputs = std::vector<TensorSpec>(weights.size(), row_major({1})),
                    .reference = reference});
  }
}

}  // namespace vkopple
