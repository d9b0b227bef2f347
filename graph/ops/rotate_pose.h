#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Distributions over yaw turned by distributions over a turn, both as logarithms (B, K, b): the circular
/// convolution out[m] = logsumexp_n (log_p[n] + log_g[m − n]), docs/model.md §4.
class RotatePose : public Op {
 public:
  std::string_view name() const override { return "rotate_pose"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value rotate_pose(Value log_p, Value log_g);

}  // namespace vkopple
