#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Joins tensors along one axis: any number row-major, along any axis; up to kMostInputs of NC4HW4, along their
/// channels.
class Concat : public Op {
 public:
  static constexpr size_t kMostInputs = 6;
  explicit Concat(size_t axis) : axis_(axis) {}
  std::string_view name() const override { return "concat"; }
  size_t axis() const { return axis_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  void interleave(Recorder& recorder, const Forward& io) const;

  size_t axis_;
};

Value concat(const std::vector<Value>& xs, size_t axis);

}  // namespace vkopple
