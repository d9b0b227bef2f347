#include "graph/ops/softmax.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors softmax_of(const HostTensor& x, size_t axis, bool log) {
  HostTensor y = x;
  const int64_t outer = x.shape.product(0, axis);
  const int64_t inner = x.shape.product(axis + 1, x.shape.rank());
  for (int64_t o = 0; o < outer; ++o)
    for (int64_t i = 0; i < inner; ++i) {
      const auto at = [&](int64_t k) { return static_cast<size_t>((o * x.shape[axis] + k) * inner + i); };
      double sum = 0;
      for (int64_t k = 0; k < x.shape[axis]; ++k) sum += std::exp(x.values[at(k)]);
      for (int64_t k = 0; k < x.shape[axis]; ++k)
        y.values[at(k)] = log ? x.values[at(k)] - std::log(sum) : std::exp(x.values[at(k)]) / sum;
    }
  return {y};
}

}  // namespace

void check_softmax(CheckList& list) {
  struct Case {
    TensorSpec x;
    size_t axis;
    double centre = 0;  ///< far from 0, exp alone would overflow in float
  };
  for (bool log : {false, true})
    for (const Case& c :
         {Case{row_major({1}), 0}, Case{row_major({2, 3, 120}), 2}, Case{row_major({3, 4, 5, 7}), 1},
          Case{row_major({2, 4, 6, 6}), 1}, Case{row_major({7, 3}), 0}, Case{row_major({3, 5}), 1, 300},
          Case{channels4({2, 3, 5, 7}), 1}, Case{channels4({1, 4, 3, 3}), 1},
          Case{channels4({2, 13, 2, 3}), 1, -300}, Case{channels4({1, 1, 2, 2}), 1}})
      list.push_back(
          {.label = fmt::format("{} axis {}{}", c.x.shape.text(), c.axis, log ? " log" : ""),
           .op = std::make_shared<Softmax>(c.axis, log),
           .inputs = {c.x},
           .reference = [axis = c.axis, log](const HostTensors& x) { return softmax_of(x[0], axis, log); },
           .ranges = {{c.centre - 4, c.centre + 4}}});
}

}  // namespace vkopple
