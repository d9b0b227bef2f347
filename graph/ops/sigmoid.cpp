#include "graph/ops/sigmoid.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct SigmoidPush {
  uint32_t units;
  float scale;
  float offset;
  uint32_t accumulate;
  Lanes lanes;
};

}  // namespace

std::vector<TensorSpec> Sigmoid::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].dtype == DType::kF32, "takes one tensor of floats");
  require(scale_ != 0, "takes a scale that is not 0");
  return {x[0]};
}

Needs Sigmoid::needs(std::span<const TensorSpec>, const Caps&) const { return {.inputs_for_backward = 0}; }

void Sigmoid::record_forward(Recorder& recorder, const Forward& io) const {
  const bool wide = words(io.y[0]) % 4 == 0;
  const SigmoidPush push{words(io.y[0]) / (wide ? 4 : 1), scale_, offset_, 0, lanes_of(io.y[0].spec)};
  recorder.dispatch_flat(wide ? "sigmoid.forward4" : "sigmoid.forward", (push.units + 3) / 4,
                         {io.x[0].slice, io.y[0].slice}, push);
}

void Sigmoid::record_backward(Recorder& recorder, const Backward& io) const {
  const bool wide = words(io.y[0]) % 4 == 0;
  const SigmoidPush push{words(io.y[0]) / (wide ? 4 : 1), scale_, offset_, io.accumulates(0),
                         lanes_of(io.y[0].spec)};
  recorder.dispatch_flat(wide ? "sigmoid.backward4" : "sigmoid.backward", (push.units + 3) / 4,
                         {io.y[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value sigmoid(Value x, float scale, float offset) {
  return x.graph().apply1(std::make_shared<Sigmoid>(scale, offset), {x});
}

}  // namespace vkopple
