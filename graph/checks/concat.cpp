#include "graph/ops/concat.h"

#include <fmt/format.h>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors join(const HostTensors& x, size_t axis) {
  int64_t size = 0;
  for (const HostTensor& part : x) size += part.shape[axis];
  HostTensor y(x[0].shape.with(axis, size));
  const int64_t outer = y.shape.product(0, axis);
  size_t next = 0;
  for (int64_t o = 0; o < outer; ++o)
    for (const HostTensor& part : x) {
      const int64_t run = part.shape.elements() / outer;
      for (int64_t i = 0; i < run; ++i) y.values[next++] = part.values[static_cast<size_t>(o * run + i)];
    }
  return {y};
}

}  // namespace

void check_concat(CheckList& list) {
  struct Case {
    TensorSpec like;
    size_t axis;
    std::vector<int64_t> sizes;
  };
  for (const Case& c :
       {Case{row_major({1}), 0, {1, 1}}, Case{row_major({3, 1, 7}), 1, {2, 1, 4}},
        Case{row_major({5, 3}), 1, {3}}, Case{row_major({2, 1, 4, 4}), 1, {2, 3}},
        Case{row_major({2, 3, 1}), 2, {1, 1, 2, 1, 3, 5}},
        Case{row_major({3, 1, 2}), 1, std::vector<int64_t>(34, 1)}, Case{channels4({2, 1, 3, 5}), 1, {8, 4}},
        Case{channels4({2, 1, 3, 5}), 1, {4, 5}}, Case{channels4({2, 1, 3, 3}), 1, {3, 6}},
        Case{channels4({1, 1, 2, 5}), 1, {1, 1, 1, 1, 1, 1}}, Case{channels4({2, 1, 3, 2}), 1, {4, 3, 2, 7}},
        Case{channels4({1, 1, 1, 1}), 1, {1, 1}}}) {
    std::vector<TensorSpec> inputs;
    std::string label = c.like.layout == Layout::kRowMajor ? "rows" : "NC4HW4";
    for (int64_t size : c.sizes) {
      inputs.push_back({c.like.shape.with(c.axis, size), c.like.layout, DType::kF32});
      label += " " + inputs.back().shape.text();
    }
    list.push_back({.label = label,
                    .op = std::make_shared<Concat>(c.axis),
                    .inputs = inputs,
                    .reference = [axis = c.axis](const HostTensors& x) { return join(x, axis); }});
  }
}

}  // namespace vkopple
