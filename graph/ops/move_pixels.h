#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Where each pixel goes if it belongs to each object or to the background, which is last: (B, K+1, 3, H, W) in
/// the next camera's frame. Object k: M₂₃ [R (P − X) + X + v]; background: M₂₃ P. Row-major points P (B, 3, H,
/// W), location X and velocity v (B, K, 3), M₂₃ (B, 4, 4) affine, which receives no gradient. Turns are (B, K),
/// angles ω in radians about the vertical, R = Rz(ω); or R itself, (B, K, 3, 3), taken as it is, a rotation or
/// not.
class MovePixels : public Op {
 public:
  std::string_view name() const override { return "move_pixels"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 4; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  void record_motion_gradients(Recorder& recorder, const Backward& io) const;
};

Value move_pixels(Value points, Value location, Value velocity, Value turns, Value m23);

}  // namespace vkopple
