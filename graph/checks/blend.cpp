#include "graph/ops/blend.h"

#include "graph/checks/check.h"

namespace vkopple {

void check_blend(CheckList& list) {
  for (const Shape& shape : {Shape{1, 1, 1, 1}, Shape{3, 3, 5, 7}, Shape{2, 1, 9, 8}, Shape{1, 5, 13, 11}}) {
    const auto reference = [](const HostTensors& x) {
      const Shape& s = x[1].shape;
      HostTensor y(s);
      for (int64_t b = 0; b < s[0]; ++b)
        for (int64_t c = 0; c < s[1]; ++c)
          for (int64_t i = 0; i < s[2]; ++i)
            for (int64_t j = 0; j < s[3]; ++j) {
              const double share = x[0].at(b, 0, i, j);
              y.at(b, c, i, j) = share * x[1].at(b, c, i, j) + (1 - share) * x[2].at(b, c, i, j);
            }
      return HostTensors{y};
    };
    list.push_back({.label = shape.text(),
                    .op = std::make_shared<Blend>(),
                    .inputs = {row_major(shape.with(1, 1)), row_major(shape), row_major(shape)},
                    .reference = reference,
                    .ranges = {{0.0, 1.0}}});
  }
}

}  // namespace vkopple
