#include "graph/ops/softmax.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct SoftmaxPush {
  uint32_t rows;   ///< invocations
  uint32_t size;   ///< along the axis
  uint32_t inner;  ///< units between neighbours along the axis (blocks of 4 in NC4HW4)
  uint32_t accumulate;
};

/// How a tensor is walked: which kernel, and its sizes.
struct Walk {
  std::string suffix;
  SoftmaxPush push;
};

Walk walk_of(const TensorSpec& spec, size_t axis, uint32_t accumulate) {
  const Shape& shape = spec.shape;
  if (spec.layout == Layout::kChannels4) {
    const int64_t pixels = shape[2] * shape[3];
    return {"_channels", {u32(shape[0] * pixels), u32(shape[1]), u32(pixels), accumulate}};
  }
  const int64_t inner = shape.product(axis + 1, shape.rank());
  const int64_t unit = inner % 4 == 0 ? 4 : 1;
  return {unit == 4 ? "4" : "",
          {u32(shape.product(0, axis) * inner / unit), u32(shape[axis]), u32(inner / unit), accumulate}};
}

}  // namespace

std::vector<TensorSpec> Softmax::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].dtype == DType::kF32, "takes one tensor of floats");
  require(axis_ < x[0].shape.rank(), fmt::format("{} has no axis {}", x[0].shape.text(), axis_));
  require(x[0].layout == Layout::kRowMajor || axis_ == 1, "takes NC4HW4 along its channels only");
  return {x[0]};
}

Needs Softmax::needs(std::span<const TensorSpec>, const Caps&) const { return {.inputs_for_backward = 0}; }

void Softmax::record_forward(Recorder& recorder, const Forward& io) const {
  const Walk walk = walk_of(io.y[0].spec, axis_, 0);
  recorder.dispatch_flat("softmax.forward" + walk.suffix, walk.push.rows, {io.x[0].slice, io.y[0].slice},
                         walk.push, {log_});
}

void Softmax::record_backward(Recorder& recorder, const Backward& io) const {
  const Walk walk = walk_of(io.y[0].spec, axis_, io.accumulates(0));
  recorder.dispatch_flat("softmax.backward" + walk.suffix, walk.push.rows,
                         {io.y[0].slice, io.dy[0].slice, io.dx[0].slice}, walk.push, {log_});
}

Value softmax(Value x, size_t axis, bool log) {
  return x.graph().apply1(std::make_shared<Softmax>(axis, log), {x});
}

}  // namespace vkopple
