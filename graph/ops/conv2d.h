#pragma once

#include <string>

#include "graph/conv/conv_op.h"
#include "graph/graph.h"

namespace vkopple {

struct Conv2dOptions {
  int64_t stride = 1;  ///< 1 or 2
  int64_t padding = 0;
  int64_t dilation = 1;
  std::string kernel = {};  ///< forces an algorithm (graph/conv/convolution.h), for tests and timing
};

/// y[n, co, yo, xo] = b[co] + Σ ci,ky,kx  x[n, ci, yo · stride + ky · dilation − padding, …] · w[co, ci, ky,
/// kx] x (N, Ci, H, W) and y (N, Co, Ho, Wo) NC4HW4, w (Co, Ci, k, k) and b (Co) row-major, b absent with
/// has_bias false; Ho = ⌊(H + 2 padding − dilation (k − 1) − 1) / stride⌋ + 1.
class Conv2d : public Op {
 public:
  explicit Conv2d(Conv2dOptions options, bool has_bias) : options_(std::move(options)), has_bias_(has_bias) {}
  std::string_view name() const override { return "conv2d"; }
  const Conv2dOptions& options() const { return options_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
  /// The sizes of the convolution of an x and w that fit.
  ConvShape shape_of(const Shape& x, const Shape& w) const;

 private:
  ConvOp conv_of(const Shape& x, const Shape& w) const;

  Conv2dOptions options_;
  bool has_bias_;
};

/// An empty b leaves the bias out.
Value conv2d(Value x, Value w, Value b, const Conv2dOptions& options = {});

}  // namespace vkopple
