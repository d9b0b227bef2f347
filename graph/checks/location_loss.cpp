#include "graph/ops/location_loss.h"

#include "graph/checks/check.h"

namespace vkopple {

void check_location_loss(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y({1});
    for (int64_t b = 0; b < x[2].shape[0]; ++b)
      for (int64_t k = 0; k < x[2].shape[1]; ++k)
        for (int64_t d = 0; d < x[0].shape[2]; ++d) {
          const double difference = x[0].at(b, k, d) - x[1].at(b, k, d);
          y.values[0] += x[2].at(b, k) * difference * difference / static_cast<double>(x[2].shape[0]);
        }
    return HostTensors{y};
  };
  for (const Shape& x : {Shape{1, 1, 3}, Shape{2, 3, 3}, Shape{20, 3, 3}, Shape{131, 5, 3}, Shape{7, 2, 9}})
    list.push_back({.label = x.text(),
                    .op = std::make_shared<LocationLoss>(),
                    .inputs = {row_major(x), row_major(x), row_major({x[0], x[1]})},
                    .reference = reference,
                    .ranges = {{-2, 2}, {-2, 2}, {0, 1}}});
}

}  // namespace vkopple
