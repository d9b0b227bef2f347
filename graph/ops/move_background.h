#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Where each pixel goes if nothing moves but the camera: (B, 1, 3, H, W) = M₂₃ P for row-major points P
/// (B, 3, H, W) and affine M₂₃ (B, 4, 4), which receives no gradient. MovePixels without objects.
class MoveBackground : public Op {
 public:
  std::string_view name() const override { return "move_background"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input == 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value move_background(Value points, Value m23);

}  // namespace vkopple
