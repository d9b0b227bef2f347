#pragma once

#include "graph/op.h"

namespace vkopple {

/// What ops share that give (N, C, H, W) in NC4HW4 another height and width by a linear formula. The kernels
/// are the variants `forward` and `backward` of the shader with the op's name.
class Resampling : public Op {
 public:
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 protected:
  Resampling(int64_t height, int64_t width) : height_(height), width_(width) {}

 private:
  int64_t height_;
  int64_t width_;
};

}  // namespace vkopple
