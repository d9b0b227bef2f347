#pragma once

#include "graph/graph.h"

namespace vkopple {

/// −(mean over the batch of Σ_k q_k min(‖X1_k[perm b] − X3_k‖₁, 1)), of shape (1) (§6): location1 X1 and
/// location3 X3 (B, K, 3), q (B, K), permutation (B) of unsigned integers below B. Where the norm is above 1
/// its gradient is 0.
class CollapseLoss : public Op {
 public:
  std::string_view name() const override { return "collapse_loss"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 3; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value collapse_loss(Value location1, Value location3, Value q, Value permutation);

}  // namespace vkopple
