#pragma once

#include "graph/graph.h"

namespace vkopple {

/// −(mean over the batch of Σ_{k<l} min(|x_k − x_l|, 1)), of shape (1): slots of one image are pushed apart to
/// the left and right of each other, until they are a scene unit apart, as the collapse loss (§6) does with
/// those of two images. Only x counts of their locations: height and distance, which hardly tell objects on a
/// floor apart in an image, would give way first. It is 0 of one slot. location: row-major (B, K, 3). Beyond a
/// distance of 1 its gradient is 0.
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
