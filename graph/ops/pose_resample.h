#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Distributions over yaw as seen after a turn of the camera (docs/model.md §4): log p (B, K, b), first rows
/// (A, b) of circulant matrices T[m, n] = row[(n − m) mod b], constant, and which of them belongs to each entry
/// of the batch (B), whole numbers below A (larger ones count as A − 1) → log-softmax(T log p), (B, K, b). The
/// rows' entries alternate and cancel, so the products are summed with twice the precision.
class PoseResample : public Op {
 public:
  std::string_view name() const override { return "pose_resample"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input == 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value pose_resample(Value log_p, Value table, Value index);

}  // namespace vkopple
