#include "graph/ops/binary.h"

#include <algorithm>

#include "graph/kernels/add_scaled.h"
#include "graph/kernels/strided_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct SamePush {
  uint32_t units;
  uint32_t accumulate;
};

struct BroadcastPush {
  uint32_t words;
  std::array<uint32_t, Binary::kMostAxes> sizes;
  std::array<uint32_t, Binary::kMostAxes> a_strides;
  std::array<uint32_t, Binary::kMostAxes> b_strides;
};

/// to (+)= a kind b, all of one specification.
void combine(Recorder& recorder, BinaryKind kind, const Operand& a, const Operand& b, const Operand& to,
             uint32_t accumulate) {
  const bool wide = words(to) % 4 == 0;
  const SamePush push{words(to) / (wide ? 4 : 1), accumulate};
  recorder.dispatch_units(wide ? "binary.same4" : "binary.same", push.units, {wide},
                          {a.slice, b.slice, to.slice, to.slice}, push, {static_cast<uint32_t>(kind)});
}

/// The gradient of `part`: dy, times the other factor where there is one, summed over the axes that repeat it.
StridedSum gradient_sum(const Shape& part, const Shape& other, const Shape& space) {
  const auto own = broadcast_strides(part, space);
  const auto dy = broadcast_strides(space, space);
  const auto factor = broadcast_strides(other, space);
  std::vector<StridedSum::Axis> axes;
  for (size_t i = 0; i < space.rank(); ++i)
    axes.push_back({.size = space[i], .summed = own[i] == 0, .x_stride = dy[i], .w_stride = factor[i]});
  return StridedSum(axes);
}

}  // namespace

std::vector<TensorSpec> Binary::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes two inputs");
  const Shape& a = x[0].shape;
  const Shape& b = x[1].shape;
  const std::string both = a.text() + " and " + b.text();
  require(x[0].dtype == DType::kF32 && x[1].dtype == DType::kF32, "takes floats");
  require(x[0].layout == x[1].layout, both + " have different layouts");
  if (x[0] == x[1]) return {x[0]};
  require(x[0].layout == Layout::kRowMajor, both + " in NC4HW4 must have one shape");
  const size_t rank = std::max(a.rank(), b.rank());
  require(rank <= kMostAxes, both + " have more axes than can be broadcast");
  std::array<int64_t, kMostAxes> sizes{};
  for (size_t i = 0; i < rank; ++i) {
    const int64_t m = i < a.rank() ? a.back(i) : 1;
    const int64_t n = i < b.rank() ? b.back(i) : 1;
    require(m == n || m == 1 || n == 1, both + " don't fit each other");
    sizes[rank - 1 - i] = std::max(m, n);
  }
  return {row_major(Shape(std::span(sizes).first(rank)))};
}

Needs Binary::needs(std::span<const TensorSpec> x, const Caps&) const {
  Needs needs{.inputs_for_backward = kind_ == BinaryKind::kMul ? 3U : 0U, .outputs_for_backward = 0};
  if (x[0] == x[1]) return needs;
  const Shape space = infer(x)[0].shape;
  needs.backward_scratch = std::max(gradient_sum(x[0].shape, x[1].shape, space).scratch_bytes(),
                                    gradient_sum(x[1].shape, x[0].shape, space).scratch_bytes());
  return needs;
}

void Binary::record_forward(Recorder& recorder, const Forward& io) const {
  if (io.x[0].spec == io.x[1].spec) {
    combine(recorder, kind_, io.x[0], io.x[1], io.y[0], 0);
    return;
  }
  const Shape& space = io.y[0].shape();
  const auto a = broadcast_strides(io.x[0].shape(), space);
  const auto b = broadcast_strides(io.x[1].shape(), space);
  BroadcastPush push{.words = words(io.y[0]), .sizes = {}, .a_strides = {}, .b_strides = {}};
  push.sizes.fill(1);
  for (size_t i = 0; i < space.rank(); ++i) {
    const size_t to = kMostAxes - space.rank() + i;
    push.sizes[to] = u32(space[i]);
    push.a_strides[to] = u32(a[i]);
    push.b_strides[to] = u32(b[i]);
  }
  recorder.dispatch_flat("binary.broadcast", push.words, {io.x[0].slice, io.x[1].slice, io.y[0].slice}, push,
                         {static_cast<uint32_t>(kind_)});
}

void Binary::record_backward(Recorder& recorder, const Backward& io) const {
  const bool same = io.x[0].spec == io.x[1].spec;
  for (size_t i = 0; i < 2; ++i) {
    if (!io.wants(i)) continue;
    const Operand& other = io.x[1 - i];
    const bool product = kind_ == BinaryKind::kMul;
    const float sign = kind_ == BinaryKind::kSub && i == 1 ? -1.0F : 1.0F;
    const uint32_t accumulate = io.accumulates(i);
    if (same && product)
      combine(recorder, BinaryKind::kMul, io.dy[0], other, io.dx[i], accumulate);
    else if (io.x[i].spec == io.dy[0].spec && !product)
      add_scaled(recorder, io.dy[0], io.dx[i], sign, accumulate != 0);
    else
      gradient_sum(io.x[i].shape(), other.shape(), io.dy[0].shape())
          .record(recorder, io.dy[0].slice, product ? other.slice : Slice{}, io.dx[i].slice, io.scratch, sign,
                  accumulate != 0);
  }
}

Value add(Value a, Value b) { return a.graph().apply1(std::make_shared<Binary>(BinaryKind::kAdd), {a, b}); }
Value sub(Value a, Value b) { return a.graph().apply1(std::make_shared<Binary>(BinaryKind::kSub), {a, b}); }
Value mul(Value a, Value b) { return a.graph().apply1(std::make_shared<Binary>(BinaryKind::kMul), {a, b}); }

}  // namespace vkopple
