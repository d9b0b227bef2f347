#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Entries begin … begin + count − 1 of one axis: any axis row-major, axis 0 or 1 of NC4HW4.
class SliceOp : public Op {
 public:
  SliceOp(size_t axis, int64_t begin, int64_t count) : axis_(axis), begin_(begin), count_(count) {}
  std::string_view name() const override { return "slice"; }
  size_t axis() const { return axis_; }
  int64_t begin() const { return begin_; }
  int64_t count() const { return count_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  bool channels(const TensorSpec& x) const { return x.layout == Layout::kChannels4 && axis_ == 1; }

  size_t axis_;
  int64_t begin_;
  int64_t count_;
};

Value slice(Value x, size_t axis, int64_t begin, int64_t count);
/// The same of axis 0, without copying where the entry can be bound in place.
Value take_outer(Value x, int64_t begin, int64_t count);

}  // namespace vkopple
