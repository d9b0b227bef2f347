#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Zeros around an NC4HW4 tensor (N, C, H, W): rows at its top and bottom, columns at its left and right.
class Pad : public Op {
 public:
  Pad(int64_t top, int64_t bottom, int64_t left, int64_t right)
      : top_(top), bottom_(bottom), left_(left), right_(right) {}
  std::string_view name() const override { return "pad"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t top_;
  int64_t bottom_;
  int64_t left_;
  int64_t right_;
};

Value pad(Value x, int64_t top, int64_t bottom, int64_t left, int64_t right);

}  // namespace vkopple
