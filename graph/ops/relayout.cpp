#include "graph/ops/relayout.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct RelayoutPush {
  uint32_t units;
  uint32_t pixels;
  uint32_t channels;
  uint32_t accumulate;
};

/// Between layouts, whichever side is NC4HW4.
void convert(Recorder& recorder, const Operand& from, const Operand& to, bool accumulate) {
  const Shape& shape = to.shape();
  const int64_t pixels = shape[2] * shape[3];
  const bool wide = pixels % 4 == 0;
  const RelayoutPush push{.units = u32(shape[0] * blocks4(shape[1]) * pixels / (wide ? 4 : 1)),
                          .pixels = u32(pixels),
                          .channels = u32(shape[1]),
                          .accumulate = accumulate};
  const std::string_view shader = to.spec.layout == Layout::kChannels4
                                      ? (wide ? "relayout.pack4" : "relayout.pack")
                                      : (wide ? "relayout.unpack4" : "relayout.unpack");
  recorder.dispatch_flat(shader, push.units, {from.slice, to.slice}, push);
}

Value with_layout(Value x, Layout layout) {
  if (x.spec().layout == layout) return x;
  return x.graph().apply1(std::make_shared<Relayout>(layout), {x});
}

}  // namespace

std::vector<TensorSpec> Relayout::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  require(x[0].shape.rank() == 4, "takes shapes (N, C, H, W), not " + x[0].shape.text());
  require(x[0].dtype == DType::kF32 && x[0].layout != to_,
          "takes a tensor of floats in the layout that it changes");
  return {{x[0].shape, to_, DType::kF32}};
}

Needs Relayout::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Relayout::record_forward(Recorder& recorder, const Forward& io) const {
  convert(recorder, io.x[0], io.y[0], false);
}

void Relayout::record_backward(Recorder& recorder, const Backward& io) const {
  convert(recorder, io.dy[0], io.dx[0], io.accumulates(0) != 0);
}

Value to_row_major(Value x) { return with_layout(x, Layout::kRowMajor); }
Value to_channels4(Value x) { return with_layout(x, Layout::kChannels4); }

}  // namespace vkopple
