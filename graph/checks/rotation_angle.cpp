#include "graph/ops/rotation_angle.h"

#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

/// Makes unit vectors, none next to the jump at half a turn.
void unit_directions(HostTensors& x) {
  for (size_t i = 0; i < x[0].values.size(); i += 2) {
    const double angle = 3.1 * x[0].values[i];
    x[0].values[i] = std::cos(angle);
    x[0].values[i + 1] = std::sin(angle);
  }
}

}  // namespace

void check_rotation_angle(CheckList& list) {
  const auto reference = [](const HostTensors& x) {
    HostTensor y = x[1];
    for (int64_t b = 0; b < y.shape[0]; ++b)
      for (int64_t k = 0; k < y.shape[1]; ++k)
        y.at(b, k) = std::atan2(x[0].at(b, k, 1), x[0].at(b, k, 0)) * (x[1].at(b, k) + 1e-8);
    return HostTensors{y};
  };
  for (const Shape& q : {Shape{1, 1}, Shape{20, 3}, Shape{64, 1}})
    list.push_back({.label = q.text(),
                    .op = std::make_shared<RotationAngle>(),
                    .inputs = {row_major({q[0], q[1], 2}), row_major(q)},
                    .reference = reference,
                    .ranges = {{-1, 1}, {0, 1}},
                    .prepare = unit_directions});
}

}  // namespace vkopple
