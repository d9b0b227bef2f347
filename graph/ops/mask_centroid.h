#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Where masks are, Σ π P / (Σ π + 1e-22) of the points that each covers (§6), of shape (B, K, 3). masks
/// (B, K + 1, H, W), whose last is background and has none; points (B, 3, H, W); all row-major.
class MaskCentroid : public Op {
 public:
  std::string_view name() const override { return "mask_centroid"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value mask_centroid(Value masks, Value points);

}  // namespace vkopple
