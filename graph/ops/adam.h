#pragma once

#include "graph/graph.h"

namespace vkopple {

struct AdamOptions {
  float learning_rate = 3e-4F;
  float beta1 = 0.9F;
  float beta2 = 0.999F;
  float epsilon = 1e-6F;
  float clip = 1.0F;  ///< gradients are clipped by value to ±clip first
};

/// One step of Adam (Kingma and Ba, 2015) on flat tensors of one size, in place:
///   g = clamp(gradient, ±clip); m = β₁ m + (1 − β₁) g; v = β₂ v + (1 − β₂) g²; p −= lr / c₁ · m / (√v / √c₂ +
///   ε)
/// Inputs: parameters, gradient, m, v, and correction (2) = (c₁, c₂) = (1 − β₁ᵗ, 1 − β₂ᵗ) of the steps before,
/// zeros at first. The corrections follow c ← β c + (1 − β), which keeps the digits that a float power would
/// lose.
class Adam : public Op {
 public:
  explicit Adam(const AdamOptions& options) : options_(options) {}
  std::string_view name() const override { return "adam"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t) const override { return false; }
  bool mutates(size_t input) const override { return input != 1; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  AdamOptions options_;
};

/// Adds the update of a parameter group from its gradient, with the state group "adam/<group>". Call it after
/// the group's last parameter was declared.
void adam(Graph& graph, const std::string& group, const AdamOptions& options);

}  // namespace vkopple
