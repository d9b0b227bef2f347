#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Bilinear resizing of (N, C, H, W) in NC4HW4 to another height and width with aligned corners: row i of the
/// result lies at i (H − 1) / (height − 1) of the input, at 0 where height is 1; columns likewise.
class ResizeBilinear : public Op {
 public:
  ResizeBilinear(int64_t height, int64_t width) : height_(height), width_(width) {}
  std::string_view name() const override { return "resize_bilinear"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t height_;
  int64_t width_;
};

Value resize_bilinear(Value x, int64_t height, int64_t width);

}  // namespace vkopple
