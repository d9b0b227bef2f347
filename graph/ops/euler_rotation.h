#pragma once

#include "graph/kernels/turn_op.h"

namespace vkopple {

/// Rotations (B, K, 3, 3) = Rz(yaw) Rx(pitch) Ry(roll), of cosine and sine of each of these angles, pair by
/// pair (B, K, 6). Only the direction of a pair counts. One shorter than 1e-4 has none: it is taken as (1, 0)
/// and gets no gradient.
class EulerRotation : public TurnOp {
 public:
  EulerRotation() : TurnOp("euler_rotation", {6}, {3, 3}) {}
};

Value euler_rotation(Value pairs);

}  // namespace vkopple
