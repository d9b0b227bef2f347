#include "graph/ops/leaky_relu.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct LeakyReluPush {
  uint32_t units;  ///< words, or vec4s where they are whole
  float slope;
  uint32_t accumulate;
};

}  // namespace

std::vector<TensorSpec> LeakyRelu::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  return {x[0]};
}

Needs LeakyRelu::needs(std::span<const TensorSpec>, const Caps&) const {
  // The output has the input's sign (slope > 0), so backward needs no input.
  return {.inputs_for_backward = 0};
}

void LeakyRelu::record_forward(Recorder& recorder, const Forward& io) const {
  const bool wide = words(io.y[0]) % 4 == 0;
  const LeakyReluPush push{words(io.y[0]) / (wide ? 4 : 1), slope_, 0};
  recorder.dispatch_units(wide ? "leaky_relu.forward4" : "leaky_relu.forward", push.units, {wide},
                          {io.x[0].slice, io.y[0].slice}, push);
}

void LeakyRelu::record_backward(Recorder& recorder, const Backward& io) const {
  const bool wide = words(io.y[0]) % 4 == 0;
  const LeakyReluPush push{words(io.y[0]) / (wide ? 4 : 1), slope_, io.accumulates(0)};
  const Slice dx = io.dx[0].slice;
  recorder.dispatch_units(wide ? "leaky_relu.backward4" : "leaky_relu.backward", push.units, {wide},
                          {io.y[0].slice, io.dy[0].slice, dx, dx}, push);
}

Value leaky_relu(Value x, float slope) { return x.graph().apply1(std::make_shared<LeakyRelu>(slope), {x}); }

}  // namespace vkopple
