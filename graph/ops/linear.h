#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = x wᵀ + b. Inputs: x (…, I), w (O, I), b (O) where there is one; y (…, O). All row-major.
class Linear : public Op {
 public:
  explicit Linear(bool bias) : bias_(bias) {}
  std::string_view name() const override { return "linear"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  bool bias_;
};

/// b may be empty.
Value linear(Value x, Value w, Value b);

}  // namespace vkopple
