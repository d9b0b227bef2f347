#pragma once

#include "graph/graph.h"

namespace vkopple {

/// The window (top, left, height, width) of an NC4HW4 tensor (N, C, H, W).
class Crop : public Op {
 public:
  Crop(int64_t top, int64_t left, int64_t height, int64_t width)
      : top_(top), left_(left), height_(height), width_(width) {}
  std::string_view name() const override { return "crop"; }
  int64_t top() const { return top_; }
  int64_t left() const { return left_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool recomputes() const override { return true; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  int64_t top_;
  int64_t left_;
  int64_t height_;
  int64_t width_;
};

Value crop(Value x, int64_t top, int64_t left, int64_t height, int64_t width);

}  // namespace vkopple
