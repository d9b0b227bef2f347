#include "graph/ops/move_background.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_move_background(CheckList& list) {
  for (const Shape& points : {Shape{1, 3, 1, 1}, Shape{3, 3, 5, 7}, Shape{2, 3, 17, 19}}) {
    const auto reference = [](const HostTensors& x) {
      const Shape& s = x[0].shape;
      HostTensor moved({s[0], 1, 3, s[2], s[3]});
      for (int64_t b = 0; b < s[0]; ++b)
        for (int64_t row = 0; row < 3; ++row)
          for (int64_t i = 0; i < s[2]; ++i)
            for (int64_t j = 0; j < s[3]; ++j) {
              double sum = x[1].at(b, row, 3);
              for (int64_t column = 0; column < 3; ++column)
                sum += x[1].at(b, row, column) * x[0].at(b, column, i, j);
              moved.at(b, 0, row, i, j) = sum;
            }
      return HostTensors{moved};
    };
    list.push_back({.label = points.text(),
                    .op = std::make_shared<MoveBackground>(),
                    .inputs = {row_major(points), row_major({points[0], 4, 4})},
                    .reference = reference,
                    .ranges = {{-5.0, 5.0}}});
  }
}

}  // namespace vkopple
