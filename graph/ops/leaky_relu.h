#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = x where x > 0, slope · x elsewhere; any shape and layout. The gradient at 0 is slope · dy.
class LeakyRelu : public Op {
 public:
  explicit LeakyRelu(float slope) : slope_(slope) {}
  std::string_view name() const override { return "leaky_relu"; }
  float slope() const { return slope_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  int in_place() const override { return 0; }
  int gradient_in_place() const override { return 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  float slope_;
};

Value leaky_relu(Value x, float slope);

}  // namespace vkopple
