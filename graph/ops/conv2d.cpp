#include "graph/ops/conv2d.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/conv/convolution.h"
#include "graph/conv/weight_gradient.h"

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

Needs Conv2d::needs(std::span<const TensorSpec> x, const Caps& caps) const {
  const ConvShape shape = shape_of(x[0].shape, x[1].shape);
  Needs needs;
  needs.forward_scratch = convolution_scratch(shape, ConvDirection::kForward, caps, options_.kernel);
  needs.backward_scratch =
      std::max(convolution_scratch(shape, ConvDirection::kTransposed, caps, options_.kernel),
               convolution_weight_gradient_scratch(shape, caps, options_.kernel));
  if (has_bias_)
    needs.backward_scratch = std::max(needs.backward_scratch, bias_gradient_scratch(infer(x)[0], caps));
  needs.inputs_for_backward = 0b011;
  needs.outputs_for_backward = 0;
  needs.forward_flop = shape.flop();
  needs.backward_flop = 2 * shape.flop();
  return needs;
}

void Conv2d::record_forward(Recorder& recorder, const Forward& io) const {
  const ConvShape shape = shape_of(io.x[0].shape(), io.x[1].shape());
  record_convolution(recorder, shape, ConvDirection::kForward,
                     {.in = io.x[0].slice,
                      .w = io.x[1].slice,
                      .bias = has_bias_ ? io.x[2].slice : Slice{},
                      .out = io.y[0].slice},
                     io.scratch, options_.kernel);
}

void Conv2d::record_backward(Recorder& recorder, const Backward& io) const {
  const ConvShape shape = shape_of(io.x[0].shape(), io.x[1].shape());
  const Slice dy = io.dy[0].slice;
  if (io.wants(0))
    record_convolution(
        recorder, shape, ConvDirection::kTransposed,
        {.in = dy, .w = io.x[1].slice, .bias = {}, .out = io.dx[0].slice, .accumulate = io.accumulates(0)},
        io.scratch, options_.kernel);
  if (io.wants(1))
    record_convolution_weight_gradient(recorder, shape, io.x[0].slice, dy, io.dx[1].slice, io.accumulates(1),
                                       io.scratch, options_.kernel);
  if (has_bias_ && io.wants(2))
    record_bias_gradient(recorder, io.dy[0].spec, dy, io.dx[2].slice, io.accumulates(2), io.scratch);
}

Value conv2d(Value x, Value w, Value b, const Conv2dOptions& options) {
  const auto op = std::make_shared<Conv2d>(options, static_cast<bool>(b));
  return b ? x.graph().apply1(op, {x, w, b}) : x.graph().apply1(op, {x, w});
}

}  // namespace vkopple
