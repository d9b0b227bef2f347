#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Mean over B, K and 3 of (c − X)², of shape (1), with c = Σ π P / (Σ π + 1e-22) the centre of the points that
/// a mask covers (§6). masks (B, K + 1, H, W), whose last is background and gets no part; points (B, 3, H, W);
/// location X (B, K, 3); all row-major.
class CentreLoss : public Op {
 public:
  std::string_view name() const override { return "centre_loss"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value centre_loss(Value masks, Value points, Value location);

}  // namespace vkopple
