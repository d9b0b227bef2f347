#pragma once

#include "graph/graph.h"

namespace vkopple {

/// MovePixels with rotations in space: object k's pixels go to M₂₃ [R (P − X) + X + v], the background's, last,
/// to M₂₃ P: (B, K+1, 3, H, W). Row-major points P (B, 3, H, W), location X and velocity v (B, K, 3), R (B, K,
/// 3, 3), M₂₃ (B, 4, 4) affine, which receives no gradient. R is taken as it is, a rotation or not.
class TurnPixels : public Op {
 public:
  std::string_view name() const override { return "turn_pixels"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 4; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  void record_motion_gradients(Recorder& recorder, const Backward& io) const;
};

Value turn_pixels(Value points, Value location, Value velocity, Value turn, Value m23);

}  // namespace vkopple
