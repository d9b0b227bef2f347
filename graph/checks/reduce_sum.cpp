#include "graph/ops/reduce_sum.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensor& x, const std::vector<size_t>& axes, const Shape& out) {
  HostTensor y(out);
  std::vector<int64_t> indices(x.shape.rank(), 0);
  for (double v : x.values) {
    int64_t at = 0;
    for (size_t i = 0; i < indices.size(); ++i)
      if (std::find(axes.begin(), axes.end(), i) == axes.end()) at = at * x.shape[i] + indices[i];
    y.values[static_cast<size_t>(at)] += v;
    for (size_t axis = indices.size(); axis-- > 0;) {
      if (++indices[axis] < x.shape[axis]) break;
      indices[axis] = 0;
    }
  }
  return {y};
}

}  // namespace

void check_reduce_sum(CheckList& list) {
  struct Case {
    Shape x;
    std::vector<size_t> axes;
  };
  for (const Case& c : {Case{{1}, {0}}, Case{{3, 5, 7}, {1}}, Case{{3, 5, 7}, {0, 2}}, Case{{3, 5, 7}, {}},
                        Case{{2, 3, 4, 2, 3, 2}, {1, 3, 5}}, Case{{2053}, {0}}, Case{{3, 1, 521}, {2}},
                        Case{{517, 3}, {0}}, Case{{2, 3, 26, 25}, {3, 2}}, Case{{41, 2, 23}, {0, 2}}}) {
    const auto op = std::make_shared<ReduceSum>(c.axes);
    const Shape out = op->infer(std::vector<TensorSpec>{row_major(c.x)})[0].shape;
    list.push_back(
        {.label = fmt::format("{} over {}", c.x.text(), fmt::join(c.axes, ", ")),
         .op = op,
         .inputs = {row_major(c.x)},
         .reference = [axes = c.axes, out](const HostTensors& x) { return reference(x[0], axes, out); }});
  }
}

}  // namespace vkopple
