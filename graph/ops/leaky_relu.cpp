#include "graph/ops/leaky_relu.h"

namespace vkopple {
namespace {

struct LeakyReluPush {
  uint32_t words;
  float slope;
  uint32_t accumulate;
};

uint32_t words_of(const Operand& operand) { return static_cast<uint32_t>(operand.spec.bytes() / 4); }

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
  const LeakyReluPush push{words_of(io.x[0]), slope_, 0};
  recorder.dispatch_flat("leaky_relu.forward", (push.words + 3) / 4, {io.x[0].slice, io.y[0].slice}, push);
}

void LeakyRelu::record_backward(Recorder& recorder, const Backward& io) const {
  const LeakyReluPush push{words_of(io.y[0]), slope_, io.accumulates(0)};
  recorder.dispatch_flat("leaky_relu.backward", (push.words + 3) / 4,
                         {io.y[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value leaky_relu(Value x, float slope) { return x.graph().apply1(std::make_shared<LeakyRelu>(slope), {x}); }

}  // namespace vkopple
