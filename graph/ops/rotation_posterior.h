#pragma once

#include "graph/graph.h"

namespace vkopple {

/// How far an object turned between two distributions over its yaw, given as logarithms (B, K, b)
/// (docs/model.md §4): log g (B, K, b), the posterior of a turn by each number of bins under a von Mises prior
/// of concentration `prior_kappa`, and its mean direction as (cosine, sine), (B, K, 2).
class RotationPosterior : public Op {
 public:
  explicit RotationPosterior(float prior_kappa) : prior_kappa_(prior_kappa) {}
  std::string_view name() const override { return "rotation_posterior"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  float prior_kappa_;
};

/// {log g, direction}.
std::vector<Value> rotation_posterior(Value log_p1, Value log_p2, float prior_kappa = 0.2F);

}  // namespace vkopple
