#pragma once

#include "graph/graph.h"

namespace vkopple {

/// y = a + b in NC4HW4, b repeated over the slots: a (F·K·inner, C, H, W) has its samples in the order (f, k,
/// i), b (F·inner, C, H, W) in the order (f, i); K follows from the shapes. db is summed over k in order.
class AddRepeated : public Op {
 public:
  explicit AddRepeated(int64_t inner) : inner_(inner) {}
  std::string_view name() const override { return "add_repeated"; }
  int64_t inner() const { return inner_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  int in_place() const override { return 0; }
  int gradient_in_place() const override { return 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t inner_;
};

Value add_repeated(Value a, Value b, int64_t inner);

}  // namespace vkopple
