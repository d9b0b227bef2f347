#include "graph/ops/permute.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct PermutePush {
  uint32_t words;
  uint32_t accumulate;
  std::array<uint32_t, Shape::kMaxRank> sizes;    ///< of the output
  std::array<uint32_t, Shape::kMaxRank> strides;  ///< in the input, of the output's axes
};

/// Writes `to`, whose axis i is axis order[i] of `from`.
void record(Recorder& recorder, const Operand& from, const Operand& to, const std::vector<size_t>& order,
            bool accumulate) {
  PermutePush push{words(to), accumulate, {}, {}};
  // Axes that stay neighbours act as one: each costs the kernel a division.
  uint32_t axes = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t size = u32(to.shape()[i]);
    const uint32_t stride = u32(from.shape().product(order[i] + 1, order.size()));
    if (size == 1) continue;
    if (axes > 0 && push.strides[axes - 1] == size * stride)
      push.sizes[--axes] *= size;
    else
      push.sizes[axes] = size;
    push.strides[axes++] = stride;
  }
  recorder.dispatch_flat("permute", (push.words + 3) / 4, {from.slice, to.slice}, push, {axes});
}

}  // namespace

std::vector<TensorSpec> Permute::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32,
          "takes one row-major tensor of floats");
  const Shape& shape = x[0].shape;
  std::vector<size_t> axes(shape.rank());
  std::iota(axes.begin(), axes.end(), size_t{0});
  require(std::is_permutation(order_.begin(), order_.end(), axes.begin(), axes.end()),
          fmt::format("({}) is no order of the axes of {}", fmt::join(order_, ", "), shape.text()));
  std::vector<int64_t> sizes;
  for (size_t axis : order_) sizes.push_back(shape[axis]);
  return {row_major(Shape(sizes))};
}

Needs Permute::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Permute::record_forward(Recorder& recorder, const Forward& io) const {
  record(recorder, io.x[0], io.y[0], order_, false);
}

void Permute::record_backward(Recorder& recorder, const Backward& io) const {
  std::vector<size_t> inverse(order_.size());
  for (size_t i = 0; i < order_.size(); ++i) inverse[order_[i]] = i;
  record(recorder, io.dy[0], io.dx[0], inverse, io.accumulates(0) != 0);
}

Value permute(Value x, std::vector<size_t> order) {
  return x.graph().apply1(std::make_shared<Permute>(std::move(order)), {x});
}

}  // namespace vkopple
