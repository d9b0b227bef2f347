#include "graph/ops/slice.h"

#include <fmt/format.h>

#include "graph/kernels/copy_runs.h"
#include "graph/kernels/shift_channels.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

/// The entries as runs of words; a tensor's whole entries are consecutive in either layout.
Runs runs_of(const TensorSpec& whole, size_t axis, int64_t begin, int64_t count) {
  const auto outer = static_cast<uint64_t>(whole.shape.product(0, axis));
  const auto size = static_cast<uint64_t>(whole.shape[axis]);
  const uint64_t entry = words(whole) / outer / size;
  const uint64_t run = entry * static_cast<uint64_t>(count);
  return {.count = outer,
          .run = run,
          .from_stride = entry * size,
          .from_begin = entry * static_cast<uint64_t>(begin),
          .to_stride = run,
          .to_begin = 0};
}

}  // namespace

std::vector<TensorSpec> SliceOp::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  const Shape& shape = x[0].shape;
  require(x[0].dtype == DType::kF32, "takes floats");
  require(axis_ < shape.rank(), fmt::format("{} has no axis {}", shape.text(), axis_));
  require(x[0].layout == Layout::kRowMajor || axis_ < 2, "cuts NC4HW4 along axes 0 and 1 only");
  require(
      begin_ >= 0 && count_ >= 1 && count_ <= shape[axis_] - begin_,
      fmt::format("{} has no entries {} to {} of axis {}", shape.text(), begin_, begin_ + count_ - 1, axis_));
  return {{shape.with(axis_, count_), x[0].layout, x[0].dtype}};
}

Needs SliceOp::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void SliceOp::record_forward(Recorder& recorder, const Forward& io) const {
  if (channels(io.x[0].spec))
    shift_channels(recorder, io.x[0], io.y[0], begin_, false);
  else
    copy_runs(recorder, io.x[0].slice, io.y[0].slice, runs_of(io.x[0].spec, axis_, begin_, count_), false);
}

void SliceOp::record_backward(Recorder& recorder, const Backward& io) const {
  const bool accumulate = io.accumulates(0) != 0;
  if (channels(io.dx[0].spec)) {
    shift_channels(recorder, io.dy[0], io.dx[0], -begin_, accumulate);
    return;
  }
  const Runs cut = runs_of(io.dx[0].spec, axis_, begin_, count_);
  const Runs back{.count = cut.count,
                  .run = cut.run,
                  .from_stride = cut.to_stride,
                  .from_begin = 0,
                  .to_stride = cut.from_stride,
                  .to_begin = cut.from_begin};
  if (!accumulate) recorder.fill(io.dx[0].slice);
  copy_runs(recorder, io.dy[0].slice, io.dx[0].slice, back, accumulate);
}

Value slice(Value x, size_t axis, int64_t begin, int64_t count) {
  return x.graph().apply1(std::make_shared<SliceOp>(axis, begin, count), {x});
}

Value take_outer(Value x, int64_t begin, int64_t count) {
  const bool exists = x.shape().rank() > 0 && begin >= 0 && count >= 1 && count <= x.shape()[0] - begin;
  if (exists && x.graph().can_slice_outer(x, begin)) return x.graph().slice_outer(x, begin, count);
  return slice(x, 0, begin, count);
}

}  // namespace vkopple
