#include "graph/ops/mask_centroid.h"

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x) {
  const HostTensor& masks = x[0];
  const HostTensor& points = x[1];
  HostTensor y({masks.shape[0], masks.shape[1] - 1, 3});
  for (int64_t b = 0; b < y.shape[0]; ++b)
    for (int64_t k = 0; k < y.shape[1]; ++k)
      for (int64_t d = 0; d < 3; ++d) {
        double weight = 0;
        double sum = 0;
        for (int64_t i = 0; i < masks.shape[2]; ++i)
          for (int64_t j = 0; j < masks.shape[3]; ++j) {
            weight += masks.at(b, k, i, j);
            sum += masks.at(b, k, i, j) * points.at(b, d, i, j);
          }
        y.at(b, k, d) = sum / (weight + 1e-22);
      }
  return {y};
}

}  // namespace

void check_mask_centroid(CheckList& list) {
  for (const auto& shape : {Shape{1, 2, 1, 1}, {2, 4, 5, 7}, {3, 3, 9, 13}, {1, 4, 33, 31}})
    list.push_back({.label = shape.text(),
                    .op = std::make_shared<MaskCentroid>(),
                    .inputs = {row_major(shape), row_major(shape.with(1, 3))},
                    .reference = reference,
                    .ranges = {{0.05, 1}, {-3, 3}}});
}

}  // namespace vkopple
