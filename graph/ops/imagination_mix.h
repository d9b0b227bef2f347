#pragma once

#include "graph/graph.h"

namespace vkopple {

/// The imagined image (B, 3, H, W) and depth (B, 1, H, W) from the network's 5 channels for each hypothesis,
/// NC4HW4 (B·S, 5, H, W), image b's hypothesis s at b·S + s: colours σ(y₀₋₂), depth max_depth · σ(y₃) + 1e-5,
/// both averaged with weights softmax over s of y₄.
class ImaginationMix : public Op {
 public:
  ImaginationMix(int64_t slots, float max_depth) : slots_(slots), max_depth_(max_depth) {}
  std::string_view name() const override { return "imagination_mix"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t slots_;  ///< S, the background included
  float max_depth_;
};

/// slots: S, the background included. Gives image and depth.
std::vector<Value> imagination_mix(Value y, int64_t slots, float max_depth);

}  // namespace vkopple
