#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = x Φ(x) with Φ(x) = (1 + erf(x / √2)) / 2, the exact GELU; any shape and layout.
class Gelu : public Op {
 public:
  std::string_view name() const override { return "gelu"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
};

Value gelu(Value x);

}  // namespace vkopple
