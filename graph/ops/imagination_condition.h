#pragma once

#include "graph/graph.h"

namespace vkopple {

/// What the imagination network is told of each hypothesis: the camera's motion `ego` (B, E), the object's
/// velocity (B, K, 3) and its turn. A turn (B, K, 2) is a direction in the plane, and only the velocity's x and
/// y are told: (B, K+1, E + 4). A turn (B, K, 3) is a vector of space: (B, K+1, E + 6). The background, last,
/// stands still: (ego, 0, 0, 1, 0), or zeros after ego. Nothing flows back into ego.
class ImaginationCondition : public Op {
 public:
  std::string_view name() const override { return "imagination_condition"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value imagination_condition(Value ego, Value velocity, Value turn);

}  // namespace vkopple
