#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Mean over the batch of Σ_k q_k ‖a_k − x_k‖², of shape (1) (§6): aligned a and seen x (B, K, D), D being 3
/// for locations and 9 for the entries of rotations; q (B, K).
class LocationLoss : public Op {
 public:
  std::string_view name() const override { return "location_loss"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value location_loss(Value aligned, Value seen, Value q);

}  // namespace vkopple
