#pragma once

#include "graph/graph.h"

namespace vkopple {

/// direction (B, K, 2) as (cosine, sine) and q (B, K) → atan2(sine, cosine) · (q + 10⁻⁸), (B, K), in radians
/// (docs/model.md §4). The direction (0, 0) has the angle 0 and no gradient.
class RotationAngle : public Op {
 public:
  std::string_view name() const override { return "rotation_angle"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value rotation_angle(Value direction, Value q);

}  // namespace vkopple
