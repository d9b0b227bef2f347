#include "graph/ops/image_loss.h"

#include "graph/checks/check.h"

namespace vkopple {

void check_image_loss(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y({1});
    for (size_t i = 0; i < x[0].values.size(); ++i) {
      const double d = x[0].values[i] - x[1].values[i];
      y.values[0] += d * d;
    }
    y.values[0] /= static_cast<double>(x[0].shape[0]);
    return HostTensors{y};
  };
  for (const TensorSpec& spec : {row_major({1, 1, 1, 1}), row_major({2, 3, 5, 7}), row_major({3, 3, 8, 12}),
                                 row_major({5, 3, 33, 3}), channels4({2, 3, 4, 5})})
    list.push_back({.label = spec.shape.text(),
                    .op = std::make_shared<ImageLoss>(),
                    .inputs = {spec, spec},
                    .reference = reference});
}

}  // namespace vkopple
