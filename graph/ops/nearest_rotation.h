#pragma once

#include "graph/kernels/turn_op.h"

namespace vkopple {

/// The rotation nearest to each matrix m (B, K, 3, 3), the one with the largest trace of RᵀM: for a matrix of
/// positive determinant the orthogonal part of its polar decomposition. A direction's gradient is what comes in
/// divided by the sum s of two singular values, the smallest one with the determinant's sign. Where s is 0, a
/// whole circle of rotations is nearest: then R is one of them and has no gradient along the circle, since 1 /
/// s is s³ / (s⁴ + 1e-12) throughout.
class NearestRotation : public TurnOp {
 public:
  NearestRotation() : TurnOp("nearest_rotation", {3, 3}, {3, 3}) {}
};

Value nearest_rotation(Value m);

}  // namespace vkopple
