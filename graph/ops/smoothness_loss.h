#pragma once

#include "graph/graph.h"

namespace vkopple {

/// How far masks are from smooth, of shape (1): mean over the batch of the sum, over hypotheses and pairs of
/// pixels beside or above each other, of squared differences. masks: row-major (B, S, H, W).
class SmoothnessLoss : public Op {
 public:
  std::string_view name() const override { return "smoothness_loss"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value smoothness_loss(Value masks);

}  // namespace vkopple
