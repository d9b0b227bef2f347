#include "graph/ops/vector_rotation.h"

#include <fmt/format.h>

#include "graph/checks/check_turns.h"

namespace vkopple {

// Without any turn, with small ones, around where a series ends, and up to more than a whole turn.
void check_vector_rotation(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    const Shape& s = x[0].shape;
    HostTensor r({s[0], s[1], 3, 3});
    for (size_t i = 0; i < r.values.size() / 9; ++i) set_matrix(r, i, turn_about(vector_at(x[0], i)));
    return HostTensors{r};
  };
  for (const double range : {0.0, 1e-3, 0.3, 1.0, 4.0})
    for (const Shape& objects : {Shape{1, 1}, Shape{7, 3}})
      list.push_back({.label = fmt::format("{} vectors up to {}", objects.text(), range),
                      .op = std::make_shared<VectorRotation>(),
                      .inputs = {row_major({objects[0], objects[1], 3})},
                      .reference = reference,
                      .ranges = {{-range, range}}});
}

}  // namespace vkopple
