#pragma once

#include "graph/graph.h"

namespace vkopple {

/// The same values (N, C, H, W) in another layout.
class Relayout : public Op {
 public:
  explicit Relayout(Layout to) : to_(to) {}
  std::string_view name() const override { return "relayout"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  Layout to_;
};

/// Both return x itself where it has that layout already.
Value to_row_major(Value x);
Value to_channels4(Value x);

}  // namespace vkopple
