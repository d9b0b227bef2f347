#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Mean over the batch of the sum over channels and pixels of (predicted − target)², of shape (1) (§6 of the
/// model's description). Both (B, 3, H, W) of one shape and layout. No gradient to the target.
class ImageLoss : public Op {
 public:
  std::string_view name() const override { return "image_loss"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input == 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value image_loss(Value predicted, Value target);

}  // namespace vkopple
