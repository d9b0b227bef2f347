#include "graph/ops/pad.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_pad(CheckList& list) {
  struct Case {
    Shape x;
    int64_t top, bottom, left, right;
  };
  for (const Case& c : {Case{{1, 1, 1, 1}, 0, 1, 0, 0}, Case{{2, 3, 5, 7}, 1, 2, 3, 0},
                        Case{{1, 5, 6, 4}, 0, 0, 0, 1}, Case{{2, 8, 3, 3}, 1, 1, 1, 1}}) {
    const auto reference = [c](const HostTensors& x) {
      HostTensor y({c.x[0], c.x[1], c.x[2] + c.top + c.bottom, c.x[3] + c.left + c.right});
      for (int64_t n = 0; n < c.x[0]; ++n)
        for (int64_t ch = 0; ch < c.x[1]; ++ch)
          for (int64_t i = 0; i < c.x[2]; ++i)
            for (int64_t j = 0; j < c.x[3]; ++j) y.at(n, ch, i + c.top, j + c.left) = x[0].at(n, ch, i, j);
      return HostTensors{y};
    };
    list.push_back({.label = fmt::format("{} by {}, {}, {}, {}", c.x.text(), c.top, c.bottom, c.left, c.right),
                    .op = std::make_shared<Pad>(c.top, c.bottom, c.left, c.right),
                    .inputs = {channels4(c.x)},
                    .reference = reference});
  }
}

}  // namespace vkopple
