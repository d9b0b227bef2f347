#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = share · a + (1 − share) · b for row-major a and b (B, C, H, W); share (B, 1, H, W) counts for every
/// channel.
class Blend : public Op {
 public:
  std::string_view name() const override { return "blend"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value blend(Value share, Value a, Value b);

}  // namespace vkopple
