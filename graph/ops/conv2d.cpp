#include "graph/ops/conv2d.h"

#include <fmt/format.h>

#include "graph/conv/convolution.h"

namespace vkopple {
namespace {

int64_t output_size(int64_t size, int64_t kernel, const Conv2dOptions& o) {
  const int64_t room = size + 2 * o.padding - o.dilation * (kernel - 1) - 1;
  return room < 0 ? 0 : room / o.stride + 1;
}

}  // namespace

ConvShape Conv2d::shape_of(const Shape& x, const Shape& w) const {
  return {.n = x[0],
          .ci = x[1],
          .h = x[2],
          .w = x[3],
          .co = w[0],
          .ho = output_size(x[2], w[2], options_),
          .wo = output_size(x[3], w[2], options_),
          .kernel = w[2],
          .stride = options_.stride,
          .padding = options_.padding,
          .dilation = options_.dilation};
}

std::vector<TensorSpec> Conv2d::infer(std::span<const TensorSpec> x) const {
  require(x.size() == (has_bias_ ? 3U : 2U), "takes x and weights, and a bias where it has one");
  require(is_convolution_kernel(options_.kernel), fmt::format("has no kernel named '{}'", options_.kernel));
  require(options_.stride == 1 || options_.stride == 2,
          fmt::format("a stride of {}; it must be 1 or 2", options_.stride));
  require(options_.padding >= 0 && options_.dilation >= 1,
          fmt::format("padding {} and dilation {}; they must be at least 0 and 1", options_.padding,
                      options_.dilation));
  const Shape& in = x[0].shape;
  const Shape& w = x[1].shape;
  require(in.rank() == 4 && x[0] == channels4(in),
          fmt::format("x {} is not (N, C, H, W) in NC4HW4", in.text()));
  require(w.rank() == 4 && x[1] == row_major(w) && w[2] == w[3] && w[1] == in[1],
          fmt::format("weights {} are not (Co, {}, k, k) in rows, for x {}", w.text(), in[1], in.text()));
  require(!has_bias_ || x[2] == row_major({w[0]}),
          fmt::format("bias is not ({}), for weights {}", w[0], w.text()));
  const ConvShape shape = shape_of(in, w);
  require(shape.ho > 0 && shape.wo > 0,
          fmt::format("x {} is smaller than the reach of weights {} at dilation {} with padding {}", in.text(),
                      w.text(), options_.dilation, options_.padding));
  return {channels4({shape.n, shape.co, shape.ho, shape.wo})};
}

ConvOp Conv2d::conv_of(const Shape& x, const Shape& w) const {
  return {shape_of(x, w), ConvDirection::kForward, has_bias_, options_.kernel};
}

Needs Conv2d::needs(std::span<const TensorSpec> x, const Caps& caps) const {
  return conv_of(x[0].shape, x[1].shape).needs(caps);
}

void Conv2d::record_forward(Recorder& recorder, const Forward& io) const {
  conv_of(io.x[0].shape(), io.x[1].shape()).record_forward(recorder, io);
}

void Conv2d::record_backward(Recorder& recorder, const Backward& io) const {
  conv_of(io.x[0].shape(), io.x[1].shape()).record_backward(recorder, io);
}

Value conv2d(Value x, Value w, Value b, const Conv2dOptions& options) {
  const auto op = std::make_shared<Conv2d>(options, static_cast<bool>(b));
  return b ? x.graph().apply1(op, {x, w, b}) : x.graph().apply1(op, {x, w});
}

}  // namespace vkopple
