#pragma once

#include "graph/graph.h"

namespace vkopple {

/// What the imagination network sees of each hypothesis: image ⊙ mask (3 channels) and log(depth + 1e-5) ⊙
/// mask, as NC4HW4 (B·S, 4, H, W), image b's hypothesis s at b·S + s. From row-major image (B, 3, H, W), which
/// receives no gradient, depth (B, 1, H, W) and masks (B, S, H, W).
class ImaginationInput : public Op {
 public:
  std::string_view name() const override { return "imagination_input"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value imagination_input(Value image, Value depth, Value masks);

}  // namespace vkopple
