#include "graph/ops/crop.h"

#include <fmt/format.h>

#include "graph/kernels/window.h"

namespace vkopple {

std::vector<TensorSpec> Crop::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].layout == Layout::kChannels4, "takes one NC4HW4 tensor");
  const Shape& shape = x[0].shape;
  require(top_ >= 0 && left_ >= 0 && height_ >= 1 && width_ >= 1 && height_ <= shape[2] - top_ &&
              width_ <= shape[3] - left_,
          fmt::format("{} has no window of {} x {} at row {}, column {}", shape.text(), height_, width_, top_,
                      left_));
  return {channels4({shape[0], shape[1], height_, width_})};
}

Needs Crop::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Crop::record_forward(Recorder& recorder, const Forward& io) const {
  copy_window(recorder, io.x[0], io.y[0], top_, left_, false);
}

void Crop::record_backward(Recorder& recorder, const Backward& io) const {
  copy_window(recorder, io.dy[0], io.dx[0], -top_, -left_, io.accumulates(0) != 0);
}

Value crop(Value x, int64_t top, int64_t left, int64_t height, int64_t width) {
  return x.graph().apply1(std::make_shared<Crop>(top, left, height, width), {x});
}

}  // namespace vkopple
