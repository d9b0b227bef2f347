#pragma once

#include "graph/graph.h"

namespace vkopple {

/// The sum over some axes of a row-major tensor, which the result lacks; over all axes, of shape (1). Long sums
/// go in two stages of a fixed order.
class ReduceSum : public Op {
 public:
  explicit ReduceSum(std::vector<size_t> axes) : axes_(std::move(axes)) {}
  std::string_view name() const override { return "reduce_sum"; }
  const std::vector<size_t>& axes() const { return axes_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  bool summed(size_t axis) const;

  std::vector<size_t> axes_;
};

Value reduce_sum(Value x, std::vector<size_t> axes);

}  // namespace vkopple
