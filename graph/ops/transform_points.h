#pragma once

#include "graph/graph.h"

namespace vkopple {

/// m (B, 4, 4), constant, and points x (B, K, 3) → the first three rows of m applied to (x, 1): (B, K, 3).
class TransformPoints : public Op {
 public:
  std::string_view name() const override { return "transform_points"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input == 1; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value transform_points(Value m, Value x);

}  // namespace vkopple
