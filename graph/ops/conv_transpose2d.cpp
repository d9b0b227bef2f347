#include "graph/ops/conv_transpose2d.h"

#include <fmt/format.h>

#include "graph/conv/conv_product.h"

namespace vkopple {
ConvShape ConvTranspose2d::convolution_of(const Shape& x, const Shape& w) {
  return {.n = x[0],
          .ci = w[1],
          .h = 2 * x[2],
          .w = 2 * x[3],
          .co = w[0],
          .ho = x[2],
          .wo = x[3],
          .kernel = w[2],
          .stride = 2,
          .padding = w[2] == 3 ? 1 : 0,
          .dilation = 1};
}

std::vector<TensorSpec> ConvTranspose2d::infer(std::span<const TensorSpec> x) const {
  require(x.size() == (has_bias_ ? 3U : 2U), "takes x and weights, and a bias where it has one");
  require(is_conv_kernel(options_.kernel), fmt::format("has no kernel named '{}'", options_.kernel));
  const Shape& in = x[0].shape;
  const Shape& w = x[1].shape;
  require(in.rank() == 4 && x[0] == channels4(in),
          fmt::format("x {} is not (N, C, H, W) in NC4HW4", in.text()));
  require(w.rank() == 4 && x[1] == row_major(w) && w[2] == w[3] && w[0] == in[1],
          fmt::format("weights {} are not ({}, Co, k, k) in rows, for x {}", w.text(), in[1], in.text()));
  require(w[2] == 2 || w[2] == 3, fmt::format("weights {} are not 2 x 2 or 3 x 3", w.text()));
  require(!has_bias_ || x[2] == row_major({w[1]}),
          fmt::format("bias is not ({}), for weights {}", w[1], w.text()));
  return {channels4({in[0], w[1], 2 * in[2], 2 * in[3]})};
}

ConvOp ConvTranspose2d::conv_of(const Shape& x, const Shape& w) const {
  return {convolution_of(x, w), ConvDirection::kTransposed, has_bias_, options_.kernel};
}

Needs ConvTranspose2d::needs(std::span<const TensorSpec> x, const Caps& caps) const {
  return conv_of(x[0].shape, x[1].shape).needs(caps);
}

void ConvTranspose2d::record_forward(Recorder& recorder, const Forward& io) const {
  conv_of(io.x[0].shape(), io.x[1].shape()).record_forward(recorder, io);
}

void ConvTranspose2d::record_backward(Recorder& recorder, const Backward& io) const {
  conv_of(io.x[0].shape(), io.x[1].shape()).record_backward(recorder, io);
}

Value conv_transpose2d(Value x, Value w, Value b, const ConvTranspose2dOptions& options) {
  const auto op = std::make_shared<ConvTranspose2d>(options, static_cast<bool>(b));
  return b ? x.graph().apply1(op, {x, w, b}) : x.graph().apply1(op, {x, w});
}

}  // namespace vkopple
