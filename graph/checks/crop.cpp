#include "graph/ops/crop.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_crop(CheckList& list) {
  struct Case {
    Shape x;
    int64_t top, left, height, width;
  };
  for (const Case& c : {Case{{1, 1, 1, 1}, 0, 0, 1, 1}, Case{{2, 3, 5, 7}, 1, 0, 4, 5},
                        Case{{1, 5, 6, 4}, 0, 1, 5, 3}, Case{{2, 8, 9, 3}, 2, 2, 1, 1}}) {
    const auto reference = [c](const HostTensors& x) {
      HostTensor y({c.x[0], c.x[1], c.height, c.width});
      for (int64_t n = 0; n < c.x[0]; ++n)
        for (int64_t ch = 0; ch < c.x[1]; ++ch)
          for (int64_t i = 0; i < c.height; ++i)
            for (int64_t j = 0; j < c.width; ++j) y.at(n, ch, i, j) = x[0].at(n, ch, i + c.top, j + c.left);
      return HostTensors{y};
    };
    list.push_back({.label = fmt::format("{} {} x {}", c.x.text(), c.height, c.width),
                    .op = std::make_shared<Crop>(c.top, c.left, c.height, c.width),
                    .inputs = {channels4(c.x)},
                    .reference = reference});
  }
}

}  // namespace vkopple
