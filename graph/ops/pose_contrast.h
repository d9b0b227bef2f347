#pragma once

#include "graph/ops/pose_loss.h"

namespace vkopple {

/// −mean over the batch of Σ_k q_k min(D(p³_k, p¹_k[perm]), 2), of shape (1) (§6): an object's pose should not
/// be that of another scene's. log_p1 and log_p3 (B, K, b), logarithms of distributions, taken as free
/// variables by gradients; q (B, K); perm u32 (B), each scene once.
class PoseContrast : public Op {
 public:
  static constexpr float kMost = 2;
  explicit PoseContrast(PoseDivergence divergence) : divergence_(divergence) {}
  std::string_view name() const override { return "pose_contrast"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  PoseDivergence divergence_;
};

Value pose_contrast(Value log_p1, Value log_p3, Value q, Value permutation, PoseDivergence divergence);

}  // namespace vkopple
