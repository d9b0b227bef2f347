#include "graph/conv/conv_op.h"

#include <algorithm>

#include "graph/conv/convolution.h"
#include "graph/conv/weight_gradient.h"

namespace vkopple {
namespace {

ConvDirection other(ConvDirection direction) {
  return direction == ConvDirection::kForward ? ConvDirection::kTransposed : ConvDirection::kForward;
}

}  // namespace

Needs ConvOp::needs(const Caps& caps) const {
  Needs needs;
  needs.forward_scratch = convolution_scratch(shape, makes, caps, kernel);
  needs.backward_scratch = std::max(convolution_scratch(shape, other(makes), caps, kernel),
                                    convolution_weight_gradient_scratch(shape, caps, kernel));
  const TensorSpec made = makes == ConvDirection::kForward ? channels4({shape.n, shape.co, shape.ho, shape.wo})
                                                           : channels4({shape.n, shape.ci, shape.h, shape.w});
  if (has_bias) needs.backward_scratch = std::max(needs.backward_scratch, bias_gradient_scratch(made, caps));
  needs.inputs_for_backward = 0b011;
  needs.outputs_for_backward = 0;
  needs.forward_flop = shape.flop();
  needs.backward_flop = 2 * shape.flop();
  return needs;
}

void ConvOp::record_forward(Recorder& recorder, const Forward& io) const {
  record_convolution(recorder, shape, makes,
                     {.in = io.x[0].slice,
                      .w = io.x[1].slice,
                      .bias = has_bias ? io.x[2].slice : Slice{},
                      .out = io.y[0].slice},
                     io.scratch, kernel);
}

void ConvOp::record_backward(Recorder& recorder, const Backward& io) const {
  const Slice in = io.x[0].slice;
  const Slice gradient = io.dy[0].slice;
  if (io.wants(0))
    record_convolution(recorder, shape, other(makes),
                       {.in = gradient,
                        .w = io.x[1].slice,
                        .bias = {},
                        .out = io.dx[0].slice,
                        .accumulate = io.accumulates(0)},
                       io.scratch, kernel);
  // The transposed convolution's large gradient takes the part of x, its small input that of dy.
  const bool forward = makes == ConvDirection::kForward;
  if (io.wants(1))
    record_convolution_weight_gradient(recorder, shape, forward ? in : gradient, forward ? gradient : in,
                                       io.dx[1].slice, io.accumulates(1), io.scratch, kernel);
  if (has_bias && io.wants(2))
    record_bias_gradient(recorder, io.dy[0].spec, gradient, io.dx[2].slice, io.accumulates(2), io.scratch);
}

}  // namespace vkopple
