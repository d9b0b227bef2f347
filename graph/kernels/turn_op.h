#pragma once

#include <string>

#include "graph/graph.h"

namespace vkopple {

/// An op from one tensor (B, K, …) to another, object by object, whose kernels are NAME.forward (x, y) and
/// NAME.backward (x, y, dy, dx): one invocation takes one object.
class TurnOp : public Op {
 public:
  std::string_view name() const override { return name_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec>, const Caps&) const override { return {}; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 protected:
  /// from, to: of one object.
  TurnOp(std::string name, const Shape& from, const Shape& to) : name_(std::move(name)), from_(from), to_(to) {}

 private:
  std::string name_;
  Shape from_;
  Shape to_;
};

}  // namespace vkopple
