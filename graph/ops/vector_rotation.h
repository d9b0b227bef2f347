#pragma once

#include "graph/kernels/turn_op.h"

namespace vkopple {

/// The rotations (B, K, 3, 3) about vectors (B, K, 3), by angles as long as they are, in radians.
class VectorRotation : public TurnOp {
 public:
  VectorRotation() : TurnOp("vector_rotation", {3}, {3, 3}) {}
};

Value vector_rotation(Value vector);

}  // namespace vkopple
