#include "graph/ops/relayout.h"

#include "graph/checks/check.h"

namespace vkopple {

void check_relayout(CheckList& list) {
  // The check itself packs and unpacks, so the values stay what they are.
  const auto reference = [](const HostTensors& x) { return x; };
  for (const Shape& shape :
       {Shape{1, 1, 1, 1}, Shape{2, 3, 5, 7}, Shape{3, 5, 2, 6}, Shape{1, 16, 9, 8}, Shape{2, 9, 13, 3}})
    for (Layout to : {Layout::kRowMajor, Layout::kChannels4})
      list.push_back({.label = shape.text() + (to == Layout::kRowMajor ? " to rows" : " to NC4HW4"),
                      .op = std::make_shared<Relayout>(to),
                      .inputs = {to == Layout::kRowMajor ? channels4(shape) : row_major(shape)},
                      .reference = reference});
}

}  // namespace vkopple
