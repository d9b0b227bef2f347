#pragma once

#include <limits>
#include <string>

#include "graph/graph.h"

namespace vkopple {

struct AdamOptions {
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-6;
  double clip = std::numeric_limits<double>::infinity();  ///< largest magnitude of a gradient's element
};

/// One step of Adam on flat tensors, PyTorch's formula (spec section 7), with g = clamp(gradient, ±clip):
///   m ← β₁ m + (1 − β₁) g,  v ← β₂ v + (1 − β₂) g²
///   p ← p − learning_rate / c₁ · m / (√v / √c₂ + epsilon)
/// c₁ = 1 − β₁ᵗ and c₂ = 1 − β₂ᵗ grow by c ← c β + (1 − β), which keeps digits that a power in float32 would
/// lose. A NaN in the gradient is not clipped: it shows in the parameters.
/// Inputs: p, gradient, m, v (N, a multiple of 4), c (2), learning rate (1); all but gradient and learning rate
/// are updated. No outputs. With a seventh input, the state of LossScale, the gradient is multiplied by its
/// factor first, and where that is 0 nothing changes.
class Adam : public Op {
 public:
  explicit Adam(const AdamOptions& options);
  std::string_view name() const override { return "adam"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t) const override { return false; }
  bool mutates(size_t input) const override { return input != 1 && input < 5; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  AdamOptions options_;
};

/// Adds the update of a parameter group by its gradient, after all of the group's parameters are declared. Its
/// state is the group "adam/<group>": adam/<group>/m, …/v, and …/correction, which holds c₁ and c₂.
/// rate: of learning, (1), an input as learning_rate() makes it. scale: what loss_scale() returned, or none.
void adam(Graph& graph, const std::string& group, const AdamOptions& options, Value rate, Value scale = {});

/// The input "learning_rate", (1), which all updates of a graph may share.
Value learning_rate(Graph& graph);

}  // namespace vkopple
