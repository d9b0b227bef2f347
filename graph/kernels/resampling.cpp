#include "graph/kernels/resampling.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ResamplingPush {
  uint32_t vec4s;  ///< of what is written
  uint32_t height;
  uint32_t width;
  uint32_t out_height;
  uint32_t out_width;
  uint32_t accumulate;
};

ResamplingPush push_for(const Operand& x, const Operand& y, const Operand& written, uint32_t accumulate) {
  return {.vec4s = words(written) / 4,
          .height = u32(x.shape()[2]),
          .width = u32(x.shape()[3]),
          .out_height = u32(y.shape()[2]),
          .out_width = u32(y.shape()[3]),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> Resampling::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].layout == Layout::kChannels4, "takes one NC4HW4 tensor");
  require(height_ >= 1 && width_ >= 1,
          fmt::format("{} can't become {} x {} pixels", x[0].shape.text(), height_, width_));
  return {channels4({x[0].shape[0], x[0].shape[1], height_, width_})};
}

Needs Resampling::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Resampling::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0], io.y[0], io.y[0], 0);
  recorder.dispatch_flat(fmt::format("{}.forward", name()), push.vec4s, {io.x[0].slice, io.y[0].slice}, push);
}

void Resampling::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_for(io.dx[0], io.dy[0], io.dx[0], io.accumulates(0));
  recorder.dispatch_flat(fmt::format("{}.backward", name()), push.vec4s, {io.dy[0].slice, io.dx[0].slice},
                         push);
}

}  // namespace vkopple
