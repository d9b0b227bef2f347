#include "graph/ops/affine.h"

#include "graph/kernels/add_scaled.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct AffinePush {
  uint32_t units;
  float scale;
  float offset;
  Lanes lanes;
};

}  // namespace

std::vector<TensorSpec> Affine::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].dtype == DType::kF32, "takes one tensor of floats");
  return {x[0]};
}

Needs Affine::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Affine::record_forward(Recorder& recorder, const Forward& io) const {
  const bool wide = words(io.y[0]) % 4 == 0;
  const AffinePush push{words(io.y[0]) / (wide ? 4 : 1), scale_, offset_, lanes_of(io.y[0].spec)};
  recorder.dispatch_flat(wide ? "affine.vec4s" : "affine.words", (push.units + 3) / 4,
                         {io.x[0].slice, io.y[0].slice}, push);
}

void Affine::record_backward(Recorder& recorder, const Backward& io) const {
  add_scaled(recorder, io.dy[0], io.dx[0], scale_, io.accumulates(0) != 0);
}

Value affine(Value x, float scale, float offset) {
  return x.graph().apply1(std::make_shared<Affine>(scale, offset), {x});
}

}  // namespace vkopple
