#include "graph/ops/euler_rotation.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check_turns.h"

namespace vkopple {
namespace {

HostTensors rotations(const HostTensors& x) {
  const Shape& s = x[0].shape;
  HostTensor r({s[0], s[1], 3, 3});
  for (size_t i = 0; i < r.values.size() / 9; ++i) {
    const double* pairs = &x[0].values[6 * i];
    const auto angle = [&](size_t n) { return std::atan2(pairs[2 * n + 1], pairs[2 * n]); };
    set_matrix(r, i,
               product(turn_about({0, 0, angle(0)}),
                       product(turn_about({angle(1), 0, 0}), turn_about({0, angle(2), 0}))));
  }
  return {r};
}

}  // namespace

void check_euler_rotation(CheckList& list) {
  // Gradients grow as pairs shrink: those of 0.02 are already fifty times as large.
  for (const double range : {1.0, 0.02})
    for (const Shape& objects : {Shape{1, 1}, Shape{7, 3}})
      list.push_back({.label = fmt::format("{} pairs up to {}", objects.text(), range),
                      .op = std::make_shared<EulerRotation>(),
                      .inputs = {row_major({objects[0], objects[1], 6})},
                      .reference = rotations,
                      .ranges = {{-range, range}},
                      // Away from no direction at all, over the finite differences' step.
                      .prepare = [range](HostTensors& x) {
                        for (double& v : x[0].values) v += std::copysign(0.2 * range, v);
                      }});
}

}  // namespace vkopple
