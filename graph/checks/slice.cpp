#include "graph/ops/slice.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {

void check_slice(CheckList& list) {
  struct Case {
    TensorSpec x;
    size_t axis;
    int64_t begin;
    int64_t count;
  };
  for (const Case& c :
       {Case{row_major({1}), 0, 0, 1}, Case{row_major({37}), 0, 5, 11}, Case{row_major({3, 5, 7}), 1, 2, 2},
        Case{row_major({3, 5, 7}), 2, 6, 1}, Case{row_major({2, 3, 4, 8, 4}), 3, 4, 4},
        Case{row_major({2, 1, 3, 2, 3, 2}), 4, 0, 2}, Case{row_major({5, 3, 2, 2}), 0, 1, 3},
        Case{channels4({3, 5, 2, 3}), 0, 1, 2}, Case{channels4({2, 7, 3, 3}), 1, 1, 5},
        Case{channels4({2, 6, 3, 1}), 1, 4, 2}, Case{channels4({1, 13, 2, 5}), 1, 11, 1},
        Case{channels4({3, 13, 2, 2}), 1, 1, 3}, Case{channels4({3, 16, 16, 16}), 1, 4, 8},
        Case{row_major({3, 2, 1024}), 1, 1, 1}, Case{row_major({3, 516}), 1, 4, 512}}) {
    const auto reference = [c](const HostTensors& x) {
      HostTensor y(c.x.shape.with(c.axis, c.count));
      const int64_t outer = c.x.shape.product(0, c.axis);
      const int64_t inner = c.x.shape.product(c.axis + 1, c.x.shape.rank());
      size_t next = 0;
      for (int64_t o = 0; o < outer; ++o)
        for (int64_t j = c.begin; j < c.begin + c.count; ++j)
          for (int64_t i = 0; i < inner; ++i)
            y.values[next++] = x[0].values[static_cast<size_t>((o * c.x.shape[c.axis] + j) * inner + i)];
      return HostTensors{y};
    };
    list.push_back({.label = fmt::format("{} axis {} from {}, {}", c.x.shape.text(), c.axis, c.begin, c.count),
                    .op = std::make_shared<SliceOp>(c.axis, c.begin, c.count),
                    .inputs = {c.x},
                    .reference = reference});
  }
}

}  // namespace vkopple
