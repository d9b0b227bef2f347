#include "graph/ops/sigmoid.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_sigmoid(CheckList& list) {
  struct Case {
    TensorSpec x;
    float scale;
    float offset;
  };
  for (const Case& c : {Case{row_major({1}), 1, 0}, Case{row_major({3, 5, 7}), 7.2F, 1e-5F},
                        Case{row_major({4, 260}), -3, 2}, Case{channels4({2, 3, 5, 7}), 7.2F, 0.25F},
                        Case{channels4({1, 16, 9, 8}), 1, 0}, Case{channels4({3, 6, 2, 1}), 1, -0.5F}}) {
    const auto reference = [scale = static_cast<double>(c.scale),
                            offset = static_cast<double>(c.offset)](const HostTensors& x) {
      HostTensor y = x[0];
      for (double& v : y.values) v = scale / (1 + std::exp(-v)) + offset;
      return HostTensors{y};
    };
    list.push_back({.label = c.x.shape.text(),
                    .op = std::make_shared<Sigmoid>(c.scale, c.offset),
                    .inputs = {c.x},
                    .reference = reference,
                    .ranges = {{-6, 6}}});
  }
}

}  // namespace vkopple
