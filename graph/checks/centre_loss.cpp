#include "graph/ops/centre_loss.h"

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x) {
  const HostTensor& masks = x[0];
  const HostTensor& points = x[1];
  const HostTensor& location = x[2];
  double loss = 0;
  for (int64_t b = 0; b < location.shape[0]; ++b)
    for (int64_t k = 0; k < location.shape[1]; ++k)
      for (int64_t d = 0; d < 3; ++d) {
        double weight = 0;
        double sum = 0;
        for (int64_t i = 0; i < masks.shape[2]; ++i)
          for (int64_t j = 0; j < masks.shape[3]; ++j) {
            weight += masks.at(b, k, i, j);
            sum += masks.at(b, k, i, j) * points.at(b, d, i, j);
          }
        const double difference = sum / (weight + 1e-22) - location.at(b, k, d);
        loss += difference * difference;
      }
  HostTensor y({1});
  y.values[0] = loss / static_cast<double>(location.shape.elements());
  return {y};
}

}  // namespace

void check_centre_loss(CheckList& list) {
  for (const auto& [slots, shape] :
       {std::pair<int64_t, Shape>{1, {1, 2, 1, 1}}, {3, {2, 4, 5, 7}}, {2, {3, 3, 9, 13}}, {3, {1, 4, 33, 31}}})
    list.push_back({.label = shape.text(),
                    .op = std::make_shared<CentreLoss>(),
                    .inputs = {row_major(shape), row_major(shape.with(1, 3)), row_major({shape[0], slots, 3})},
                    .reference = reference,
                    .ranges = {{0.05, 1}, {-3, 3}, {-1, 1}}});
}

}  // namespace vkopple
