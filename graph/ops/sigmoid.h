#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = scale · σ(x) + offset with σ(x) = 1 / (1 + exp(−x)); any shape and layout. scale is not 0.
class Sigmoid : public Op {
 public:
  Sigmoid(float scale, float offset) : scale_(scale), offset_(offset) {}
  std::string_view name() const override { return "sigmoid"; }
  float scale() const { return scale_; }
  float offset() const { return offset_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  float scale_;
  float offset_;
};

Value sigmoid(Value x, float scale = 1, float offset = 0);

}  // namespace vkopple
