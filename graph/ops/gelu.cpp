#include "graph/ops/gelu.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct GeluPush {
  uint32_t units;  ///< words, or vec4s where they are whole
  uint32_t accumulate;
};

bool is_wide(const Operand& x) { return words(x) % 4 == 0; }

GeluPush push_of(const Operand& x, uint32_t accumulate) {
  return {words(x) / (is_wide(x) ? 4 : 1), accumulate};
}

uint32_t invocations(const GeluPush& push) { return (push.units + 3) / 4; }

}  // namespace

std::vector<TensorSpec> Gelu::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].dtype == DType::kF32, "takes one tensor of floats");
  return {x[0]};
}

Needs Gelu::needs(std::span<const TensorSpec>, const Caps&) const { return {.outputs_for_backward = 0}; }

void Gelu::record_forward(Recorder& recorder, const Forward& io) const {
  const GeluPush push = push_of(io.x[0], 0);
  recorder.dispatch_flat(is_wide(io.x[0]) ? "gelu.forward4" : "gelu.forward", invocations(push),
                         {io.x[0].slice, io.y[0].slice}, push);
}

void Gelu::record_backward(Recorder& recorder, const Backward& io) const {
  const GeluPush push = push_of(io.x[0], io.accumulates(0));
  recorder.dispatch_flat(is_wide(io.x[0]) ? "gelu.backward4" : "gelu.backward", invocations(push),
                         {io.x[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value gelu(Value x) { return x.graph().apply1(std::make_shared<Gelu>(), {x}); }

}  // namespace vkopple
