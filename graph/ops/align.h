#pragma once

#include "graph/graph.h"

namespace vkopple {

/// What is known of frame a in the order of b's slots (docs/model.md §3). log w (B, K, K) as `match` gives it,
/// location (B, K, 3) and log yaw (B, K, b) → Σ_l w_kl X_l (B, K, 3) and log p̄_k, the log-softmax of
/// logsumexp_l (log w_kl + log p_l), (B, K, b).
class Align : public Op {
 public:
  std::string_view name() const override { return "align"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

/// {location, log yaw}.
std::vector<Value> align(Value log_w, Value location, Value log_pose);

}  // namespace vkopple
