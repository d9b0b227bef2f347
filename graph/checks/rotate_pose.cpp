#include "graph/ops/rotate_pose.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_rotate_pose(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y = x[0];
    const int64_t bins = y.shape[2];
    for (int64_t n = 0; n < y.shape[0]; ++n)
      for (int64_t k = 0; k < y.shape[1]; ++k)
        for (int64_t m = 0; m < bins; ++m) {
          double sum = 0;
          for (int64_t turn = 0; turn < bins; ++turn)
            sum += std::exp(x[0].at(n, k, (m - turn + bins) % bins) + x[1].at(n, k, turn));
          y.at(n, k, m) = std::log(sum);
        }
    return HostTensors{y};
  };
  for (const Shape& shape : {Shape{1, 1, 1}, Shape{2, 3, 7}, Shape{1, 1, 120}, Shape{1, 2, 37}})
    list.push_back({.label = shape.text(),
                    .op = std::make_shared<RotatePose>(),
                    .inputs = {row_major(shape), row_major(shape)},
                    .reference = reference,
                    .ranges = {{-20, 0}, {-9, 0}}});
}

}  // namespace vkopple
