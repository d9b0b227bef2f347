#pragma once

#include "graph/graph.h"

namespace vkopple {

/// −(mean over the batch of Σ_{k<l} min(‖X_k − X_l‖₁, 1)), of shape (1): slots of one image are pushed apart
/// until they are a scene unit from each other, as the collapse loss (§6) does with those of two images. It is
/// 0 of one slot. location X: row-major (B, K, 3). Where the norm is above 1 its gradient is 0.
class SlotContrast : public Op {
 public:
  std::string_view name() const override { return "slot_contrast"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value slot_contrast(Value location);

}  // namespace vkopple
