#include "graph/ops/slot_masks.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {

void check_slot_masks(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    const Shape& s = x[0].shape;
    HostTensor masks({s[1], s[0] + 1, s[2], s[3]});
    for (int64_t b = 0; b < s[1]; ++b)
      for (int64_t i = 0; i < s[2]; ++i)
        for (int64_t j = 0; j < s[3]; ++j) {
          double sum = 1;
          for (int64_t k = 0; k < s[0]; ++k) sum += std::exp(x[0].at(k, b, i, j));
          for (int64_t k = 0; k < s[0]; ++k) masks.at(b, k, i, j) = std::exp(x[0].at(k, b, i, j)) / sum;
          masks.at(b, s[0], i, j) = 1 / sum;
        }
    return HostTensors{masks};
  };
  for (const Shape& shape : {Shape{1, 1, 1, 1}, Shape{3, 2, 5, 7}, Shape{5, 1, 8, 9}, Shape{2, 3, 13, 7}})
    list.push_back({.label = shape.text(),
                    .op = std::make_shared<SlotMasks>(),
                    .inputs = {row_major(shape)},
                    .reference = reference,
                    .ranges = {{-4.0, 4.0}}});
  // Logits that overflow exp() unless the largest of them and the background's 0 is taken off first.
  for (const double sign : {-1.0, 1.0})
    list.push_back({.label = "large logits",
                    .op = std::make_shared<SlotMasks>(),
                    .inputs = {row_major({3, 1, 4, 5})},
                    .reference = reference,
                    .ranges = {{sign * 95.0, sign * 98.0}}});
}

}  // namespace vkopple
