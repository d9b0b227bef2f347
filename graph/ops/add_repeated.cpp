#include "graph/ops/add_repeated.h"

#include <fmt/format.h>

#include "graph/kernels/add_scaled.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct AddRepeatedPush {
  uint32_t vec4s;  ///< of b
  uint32_t run;    ///< vec4s of `inner` samples
  uint32_t repeats;
  uint32_t accumulate;
};

AddRepeatedPush push_for(const Operand& a, const Operand& b, int64_t inner, uint32_t accumulate) {
  return {.vec4s = words(b) / 4,
          .run = words(b) / 4 / u32(b.shape()[0] / inner),
          .repeats = u32(a.shape()[0] / b.shape()[0]),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> AddRepeated::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes two inputs");
  require(x[0].layout == Layout::kChannels4 && x[1].layout == Layout::kChannels4, "takes NC4HW4 tensors");
  const Shape& a = x[0].shape;
  const Shape& b = x[1].shape;
  require(a.with(0, 1) == b.with(0, 1) && a[0] % b[0] == 0 && inner_ >= 1 && b[0] % inner_ == 0,
          fmt::format("{} can't be repeated onto {} with {} samples at a time", b.text(), a.text(), inner_));
  return {x[0]};
}

Needs AddRepeated::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void AddRepeated::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0], io.x[1], inner_, 0);
  recorder.dispatch_flat("add_repeated.forward", push.vec4s, {io.x[0].slice, io.x[1].slice, io.y[0].slice},
                         push);
}

void AddRepeated::record_backward(Recorder& recorder, const Backward& io) const {
  if (io.wants(0)) add_scaled(recorder, io.dy[0], io.dx[0], 1.0F, io.accumulates(0) != 0);
  if (!io.wants(1)) return;
  const auto push = push_for(io.dy[0], io.dx[1], inner_, io.accumulates(1));
  recorder.dispatch_flat("add_repeated.backward", push.vec4s, {io.dy[0].slice, io.dx[1].slice}, push);
}

Value add_repeated(Value a, Value b, int64_t inner) {
  return a.graph().apply1(std::make_shared<AddRepeated>(inner), {a, b});
}

}  // namespace vkopple
