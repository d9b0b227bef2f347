#pragma once

#include "graph/graph.h"

namespace vkopple {

/// What a network that moves single pixels reads of each: numbers (B, S, A) that all pixels of a hypothesis
/// share, its point (B, 3, H, W), both row-major, and 1, as NC4HW4 channels: (B·S, A + 4, H, W). Gradients are
/// summed in a fixed order.
class PixelCondition : public Op {
 public:
  std::string_view name() const override { return "pixel_condition"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value pixel_condition(Value shared, Value points);

}  // namespace vkopple
