#include "graph/ops/slot_contrast.h"

#include <algorithm>
#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x) {
  const Shape& shape = x[0].shape;
  HostTensor y({1});
  for (int64_t b = 0; b < shape[0]; ++b)
    for (int64_t k = 0; k < shape[1]; ++k)
      for (int64_t l = 0; l < k; ++l)
        y.values[0] -=
            std::min(std::abs(x[0].at(b, k, 0) - x[0].at(b, l, 0)), 1.0) / static_cast<double>(shape[0]);
  return {y};
}

}  // namespace

void check_slot_contrast(CheckList& list) {
  for (const Shape& location : {Shape{1, 1, 3}, Shape{2, 3, 3}, Shape{20, 3, 3}, Shape{131, 5, 3}})
    list.push_back({.label = location.text(),
                    .op = std::make_shared<SlotContrast>(),
                    .inputs = {row_major(location)},
                    .reference = reference,
                    .ranges = {{-0.8, 0.8}}});
}

}  // namespace vkopple
