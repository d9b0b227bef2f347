#include "graph/ops/pixel_condition.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors conditions(const HostTensors& x) {
  const HostTensor& shared = x[0];
  const HostTensor& points = x[1];
  const Shape& s = shared.shape;
  const Shape& image = points.shape;
  HostTensor y({s[0] * s[1], s[2] + 4, image[2], image[3]});
  for (int64_t b = 0; b < s[0]; ++b)
    for (int64_t k = 0; k < s[1]; ++k)
      for (int64_t i = 0; i < image[2]; ++i)
        for (int64_t j = 0; j < image[3]; ++j) {
          const int64_t sample = b * s[1] + k;
          for (int64_t c = 0; c < s[2]; ++c) y.at(sample, c, i, j) = shared.at(b, k, c);
          for (int64_t axis = 0; axis < 3; ++axis) y.at(sample, s[2] + axis, i, j) = points.at(b, axis, i, j);
          y.at(sample, s[2] + 3, i, j) = 1;
        }
  return {y};
}

}  // namespace

void check_pixel_condition(CheckList& list) {
  struct Case {
    int64_t batch, slots, numbers, height, width;
  };
  // 31 x 37 pixels are more than one strip; 14 numbers are those of learned motion.
  for (const Case& c : {Case{1, 1, 1, 1, 1}, Case{3, 2, 14, 5, 7}, Case{2, 1, 14, 31, 37}, Case{2, 3, 8, 9, 8},
                        Case{1, 5, 3, 4, 6}, Case{2, 2, 13, 3, 3}})
    list.push_back(
        {.label = fmt::format("{} x {}, {} numbers, {} x {}", c.batch, c.slots, c.numbers, c.height, c.width),
         .op = std::make_shared<PixelCondition>(),
         .inputs = {row_major({c.batch, c.slots, c.numbers}), row_major({c.batch, 3, c.height, c.width})},
         .reference = conditions});
}

}  // namespace vkopple
