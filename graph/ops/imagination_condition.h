#pragma once

#include "graph/graph.h"

namespace vkopple {

/// What the imagination network is told of each hypothesis, (B, K+1, 7): the camera's motion `ego` (B, 3), the
/// object's velocity x and y of (B, K, 3) and its direction of rotation (B, K, 2). The background, last, stands
/// still: (ego, 0, 0, 1, 0). Nothing flows back into ego.
class ImaginationCondition : public Op {
 public:
  std::string_view name() const override { return "imagination_condition"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value imagination_condition(Value ego, Value velocity, Value direction);

}  // namespace vkopple
