#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = softmax of x along one axis, or its logarithm: any axis row-major, the channels of NC4HW4. The largest
/// value is subtracted first.
class Softmax : public Op {
 public:
  Softmax(size_t axis, bool log) : axis_(axis), log_(log) {}
  std::string_view name() const override { return "softmax"; }
  size_t axis() const { return axis_; }
  bool log() const { return log_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  size_t axis_;
  bool log_;
};

Value softmax(Value x, size_t axis, bool log = false);

}  // namespace vkopple
