#include "graph/ops/transform_points.h"

#include "graph/checks/check.h"

namespace vkopple {

void check_transform_points(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y = x[1];
    for (int64_t b = 0; b < y.shape[0]; ++b)
      for (int64_t k = 0; k < y.shape[1]; ++k)
        for (int64_t i = 0; i < 3; ++i) {
          y.at(b, k, i) = x[0].at(b, i, 3);
          for (int64_t j = 0; j < 3; ++j) y.at(b, k, i) += x[0].at(b, i, j) * x[1].at(b, k, j);
        }
    return HostTensors{y};
  };
  for (const Shape& points : {Shape{1, 1, 3}, Shape{7, 3, 3}, Shape{3, 8, 3}})
    list.push_back({.label = points.text(),
                    .op = std::make_shared<TransformPoints>(),
                    .inputs = {row_major({points[0], 4, 4}), row_major(points)},
                    .reference = reference});
}

}  // namespace vkopple
