#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = scale · x + offset; any shape and layout.
class Affine : public Op {
 public:
  Affine(float scale, float offset) : scale_(scale), offset_(offset) {}
  std::string_view name() const override { return "affine"; }
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

Value affine(Value x, float scale, float offset);

}  // namespace vkopple
