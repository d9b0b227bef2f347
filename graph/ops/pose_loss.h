#pragma once

#include "graph/graph.h"

namespace vkopple {

/// How far two distributions are from each other.
enum class PoseDivergence : uint32_t {
  kKl,  ///< ½ (KL(p‖p̄) + KL(p̄‖p)), what the authors' implementation does
  kJs,  ///< Jensen–Shannon: the same with the mean of p and p̄ on the right
};

/// Mean over the batch of Σ_k q_k D(p_k, p̄_k), of shape (1) (§6), of the distributions whose logarithms are
/// log_p3 and log_pbar (B, K, b); q (B, K). Gradients take the logarithms as free variables.
class PoseLoss : public Op {
 public:
  explicit PoseLoss(PoseDivergence divergence) : divergence_(divergence) {}
  std::string_view name() const override { return "pose_loss"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  PoseDivergence divergence_;
};

Value pose_loss(Value log_p3, Value log_pbar, Value q, PoseDivergence divergence);

}  // namespace vkopple
