#include "graph/ops/reduce_sum.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "graph/kernels/strided_sum.h"

namespace vkopple {
namespace {

/// The walk of x that sums it, x's strides as they are.
StridedSum forward_sum(const Shape& shape, const auto& summed) {
  const auto strides = broadcast_strides(shape, shape);
  std::vector<StridedSum::Axis> axes;
  for (size_t i = 0; i < shape.rank(); ++i)
    axes.push_back({.size = shape[i], .summed = summed(i), .x_stride = strides[i], .w_stride = 0});
  return StridedSum(axes);
}

}  // namespace

bool ReduceSum::summed(size_t axis) const { return std::find(axes_.begin(), axes_.end(), axis) != axes_.end(); }

std::vector<TensorSpec> ReduceSum::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].dtype == DType::kF32 && x[0].layout == Layout::kRowMajor,
          "takes one row-major tensor of floats");
  const Shape& shape = x[0].shape;
  for (size_t axis : axes_)
    require(axis < shape.rank() && std::count(axes_.begin(), axes_.end(), axis) == 1,
            fmt::format("{} can't be summed over axes {}", shape.text(), fmt::join(axes_, ", ")));
  std::vector<int64_t> sizes;
  for (size_t i = 0; i < shape.rank(); ++i)
    if (!summed(i)) sizes.push_back(shape[i]);
  if (sizes.empty()) sizes.push_back(1);
  return {row_major(Shape(std::span<const int64_t>(sizes)))};
}

Needs ReduceSum::needs(std::span<const TensorSpec> x, const Caps&) const {
  const auto sum = forward_sum(x[0].shape, [this](size_t axis) { return summed(axis); });
  return {.forward_scratch = sum.scratch_bytes(), .inputs_for_backward = 0, .outputs_for_backward = 0};
}

void ReduceSum::record_forward(Recorder& recorder, const Forward& io) const {
  forward_sum(io.x[0].shape(), [this](size_t axis) {
    return summed(axis);
  }).record(recorder, io.x[0].slice, {}, io.y[0].slice, io.scratch, 1.0F, false);
}

void ReduceSum::record_backward(Recorder& recorder, const Backward& io) const {
  const Shape& shape = io.dx[0].shape();
  // dy repeated along the axes that were summed: a walk over x's space that sums nothing.
  std::vector<StridedSum::Axis> axes(shape.rank());
  int64_t stride = 1;
  for (size_t i = shape.rank(); i-- > 0;) {
    axes[i] = {.size = shape[i], .summed = false, .x_stride = summed(i) ? 0 : stride, .w_stride = 0};
    if (!summed(i)) stride *= shape[i];
  }
  StridedSum(axes).record(recorder, io.dy[0].slice, {}, io.dx[0].slice, {}, 1.0F, io.accumulates(0) != 0);
}

Value reduce_sum(Value x, std::vector<size_t> axes) {
  return x.graph().apply1(std::make_shared<ReduceSum>(std::move(axes)), {x});
}

}  // namespace vkopple
