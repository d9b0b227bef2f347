#pragma once

#include "graph/graph.h"

namespace vkopple {

enum class BinaryKind : uint32_t { kAdd, kSub, kMul };

/// a + b, a − b or a · b. Row-major tensors of up to 5 axes broadcast as numpy's do (axes align at the
/// innermost one, an axis of size 1 or absent repeats); in NC4HW4 both shapes are equal. Gradients are summed
/// over repeated axes in a fixed order.
class Binary : public Op {
 public:
  static constexpr size_t kMostAxes = 5;
  explicit Binary(BinaryKind kind) : kind_(kind) {}
  std::string_view name() const override { return "binary"; }
  BinaryKind kind() const { return kind_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  int in_place() const override { return 0; }
  int gradient_in_place() const override {
    return kind_ == BinaryKind::kMul ? -1 : 0;
  }  // a product reads dy twice
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  BinaryKind kind_;
};

Value add(Value a, Value b);
Value sub(Value a, Value b);
Value mul(Value a, Value b);

}  // namespace vkopple
