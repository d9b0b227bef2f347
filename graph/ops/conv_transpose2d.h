#pragma once

#include <string>

#include "graph/conv/conv_op.h"
#include "graph/graph.h"

namespace vkopple {

struct ConvTranspose2dOptions {
  std::string kernel = {};  ///< forces a family of kernels (graph/conv/conv_product.h), for tests and timing
};

/// The transposed convolution of stride 2 that doubles height and width:
///   y[n, co, 2 yi + ky − padding, 2 xi + kx − padding] += x[n, ci, yi, xi] · w[ci, co, ky, kx],  starting from
///   b[co]
/// k = 2: no padding; k = 3: padding 1 and output padding 1. x (N, Ci, H, W) and y (N, Co, 2H, 2W) NC4HW4,
/// w (Ci, Co, k, k) and b (Co) row-major, b absent with has_bias false.
class ConvTranspose2d : public Op {
 public:
  explicit ConvTranspose2d(ConvTranspose2dOptions options, bool has_bias)
      : options_(std::move(options)), has_bias_(has_bias) {}
  std::string_view name() const override { return "conv_transpose2d"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;
  /// The convolution of which this is the transpose: from y (its x) to x (its y).
  static ConvShape convolution_of(const Shape& x, const Shape& w);

 private:
  ConvOp conv_of(const Shape& x, const Shape& w) const;

  ConvTranspose2dOptions options_;
  bool has_bias_;
};

/// An empty b leaves the bias out.
Value conv_transpose2d(Value x, Value w, Value b, const ConvTranspose2dOptions& options = {});

}  // namespace vkopple
