#pragma once

#include <array>

#include "graph/graph.h"

namespace vkopple {

/// Σ weights[i] · x[i] of up to 8 tensors of shape (1), of shape (1): the total of loss terms.
class WeightedSum : public Op {
 public:
  static constexpr size_t kMostInputs = 8;
  explicit WeightedSum(std::vector<float> weights) : weights_(std::move(weights)) {}
  std::string_view name() const override { return "weighted_sum"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  std::vector<float> weights_;
};

Value weighted_sum(const std::vector<Value>& scalars, const std::vector<float>& weights);

}  // namespace vkopple
