#pragma once

#include "graph/kernels/turn_op.h"

namespace vkopple {

/// The turns of rotations (B, K, 3, 3) as vectors (B, K, 3): the axis, as long as the angle, which is at most
/// π. The gradient speaks of changes that leave a rotation one; across them it is zero. Of a turn by π both
/// vectors are right, and it is one of them.
class RotationVector : public TurnOp {
 public:
  RotationVector() : TurnOp("rotation_vector", {3, 3}, {3}) {}
};

Value rotation_vector(Value rotation);

}  // namespace vkopple
