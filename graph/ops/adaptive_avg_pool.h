#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Means over a grid of height × width bins of (N, C, H, W) in NC4HW4. Bin i spans rows ⌊i H / height⌋ up to,
/// not including, ⌈(i + 1) H / height⌉; columns likewise. Bins overlap where the sizes do not divide.
class AdaptiveAvgPool : public Op {
 public:
  AdaptiveAvgPool(int64_t height, int64_t width) : height_(height), width_(width) {}
  std::string_view name() const override { return "adaptive_avg_pool"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t height_;
  int64_t width_;
};

Value adaptive_avg_pool(Value x, int64_t height, int64_t width);

}  // namespace vkopple
