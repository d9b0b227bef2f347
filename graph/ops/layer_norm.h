#pragma once

#include "graph/graph.h"
#include "graph/norm/normalise.h"

namespace vkopple {

struct LayerNormOptions {
  float eps = 0.01F;
  float slope = 1;      ///< of a LeakyReLU before the norm, in (0, 1]; 1: none
  float dropout = 0;    ///< rate of dropout after the norm, as the op dropout
  uint32_t stream = 0;  ///< of dropout
};

/// y = dropout((leaky(x) − mean) / √(variance + eps)), mean and biased variance of each sample over its
/// channels and pixels. Inputs: x (N, C, H, W) NC4HW4; random, u32 (2), where something is dropped.
class LayerNorm : public Op {
 public:
  explicit LayerNorm(const LayerNormOptions& options);
  std::string_view name() const override { return "layer_norm"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input == 0; }
  int in_place() const override { return 0; }
  int gradient_in_place() const override { return 0; }
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  /// Applies the statistics that forward saved.
  void record_again(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  bool drops() const { return options_.dropout > 0; }
  Normalise normalise(const Shape& x, const Caps& caps) const;

  LayerNormOptions options_;
};

/// `random` may be empty where options drop nothing.
Value layer_norm(Value x, Value random, const LayerNormOptions& options);

}  // namespace vkopple
