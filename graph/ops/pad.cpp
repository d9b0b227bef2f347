#include "graph/ops/pad.h"

#include <fmt/format.h>

#include "graph/kernels/window.h"

namespace vkopple {

std::vector<TensorSpec> Pad::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].layout == Layout::kChannels4, "takes one NC4HW4 tensor");
  const Shape& shape = x[0].shape;
  require(top_ >= 0 && bottom_ >= 0 && left_ >= 0 && right_ >= 0,
          fmt::format("{} can't be padded by {}, {}, {}, {}", shape.text(), top_, bottom_, left_, right_));
  return {channels4({shape[0], shape[1], shape[2] + top_ + bottom_, shape[3] + left_ + right_})};
}

Needs Pad::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Pad::record_forward(Recorder& recorder, const Forward& io) const {
  copy_window(recorder, io.x[0], io.y[0], -top_, -left_, false);
}

void Pad::record_backward(Recorder& recorder, const Backward& io) const {
  copy_window(recorder, io.dy[0], io.dx[0], top_, left_, io.accumulates(0) != 0);
}

Value pad(Value x, int64_t top, int64_t bottom, int64_t left, int64_t right) {
  return x.graph().apply1(std::make_shared<Pad>(top, bottom, left, right), {x});
}

}  // namespace vkopple
