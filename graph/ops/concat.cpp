#include "graph/ops/concat.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/kernels/copy_runs.h"
#include "graph/kernels/shift_channels.h"
#include "graph/kernels/words.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

struct ConcatPush {
  uint32_t vec4s;
  uint32_t pixels;
  std::array<uint32_t, Concat::kMostInputs + 1> begins;  ///< channel at which each input begins, then the end
};

/// Whether a part's channels lie in whole blocks of the joined tensor (the last part's padding included).
bool whole_blocks(const TensorSpec& part, const TensorSpec& joined, int64_t begin) {
  return begin % 4 == 0 && (part.shape[1] % 4 == 0 || begin + part.shape[1] == joined.shape[1]);
}

/// Where the part that begins at entry `begin` of the axis lies in the joined tensor.
Runs runs_of(const TensorSpec& part, const TensorSpec& joined, size_t axis, int64_t begin) {
  const auto outer = static_cast<uint64_t>(part.shape.product(0, axis));
  const auto units = [&](const TensorSpec& spec, int64_t entries) {
    const int64_t size = spec.layout == Layout::kChannels4 ? blocks4(spec.shape[axis]) : spec.shape[axis];
    const int64_t at = spec.layout == Layout::kChannels4 ? entries / 4 : entries;
    return words(spec) / outer / static_cast<uint64_t>(size) * static_cast<uint64_t>(at);
  };
  const uint64_t run = words(part) / outer;
  return {.count = outer,
          .run = run,
          .from_stride = run,
          .from_begin = 0,
          .to_stride = words(joined) / outer,
          .to_begin = units(joined, begin)};
}

Runs reversed(const Runs& r) {
  return {.count = r.count,
          .run = r.run,
          .from_stride = r.to_stride,
          .from_begin = r.to_begin,
          .to_stride = r.from_stride,
          .to_begin = r.from_begin};
}

}  // namespace

std::vector<TensorSpec> Concat::infer(std::span<const TensorSpec> x) const {
  require(!x.empty(), "takes at least one input");
  const TensorSpec& first = x[0];
  require(first.layout == Layout::kRowMajor || x.size() <= kMostInputs,
          fmt::format("takes at most {} inputs of NC4HW4", kMostInputs));
  require(first.dtype == DType::kF32, "takes floats");
  require(axis_ < first.shape.rank(), fmt::format("{} has no axis {}", first.shape.text(), axis_));
  require(first.layout == Layout::kRowMajor || axis_ == 1, "joins NC4HW4 along its channels only");
  int64_t size = 0;
  for (const TensorSpec& other : x) {
    require(other.layout == first.layout && other.dtype == first.dtype &&
                other.shape.rank() == first.shape.rank() &&
                other.shape.with(axis_, 1) == first.shape.with(axis_, 1),
            fmt::format("{} and {} differ beside axis {}", first.shape.text(), other.shape.text(), axis_));
    size += other.shape[axis_];
  }
  return {{first.shape.with(axis_, size), first.layout, first.dtype}};
}

Needs Concat::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void Concat::record_forward(Recorder& recorder, const Forward& io) const {
  const TensorSpec& joined = io.y[0].spec;
  int64_t begin = 0;
  if (joined.layout == Layout::kChannels4)
    for (const Operand& x : io.x) {
      if (!whole_blocks(x.spec, joined, begin)) return interleave(recorder, io);
      begin += x.shape()[axis_];
    }
  begin = 0;
  for (const Operand& x : io.x) {
    copy_runs(recorder, x.slice, io.y[0].slice, runs_of(x.spec, joined, axis_, begin), false);
    begin += x.shape()[axis_];
  }
}

/// Where a block of the output holds channels of several inputs.
void Concat::interleave(Recorder& recorder, const Forward& io) const {
  const Shape& shape = io.y[0].shape();
  ConcatPush push{.vec4s = words(io.y[0]) / 4, .pixels = u32(shape[2] * shape[3]), .begins = {}};
  std::array<Slice, kMostInputs> x{};
  for (size_t i = 0; i < kMostInputs; ++i) {
    if (i < io.x.size()) x[i] = io.x[i].slice;
    push.begins[i + 1] = push.begins[i] + (i < io.x.size() ? u32(io.x[i].shape()[1]) : 0);
  }
  recorder.dispatch_flat("concat", (push.vec4s + 3) / 4, {x[0], x[1], x[2], x[3], x[4], x[5], io.y[0].slice},
                         push);
}

void Concat::record_backward(Recorder& recorder, const Backward& io) const {
  const TensorSpec& joined = io.dy[0].spec;
  int64_t begin = 0;
  for (size_t i = 0; i < io.x.size(); ++i) {
    const TensorSpec& part = io.x[i].spec;
    const bool accumulate = io.accumulates(i) != 0;
    if (io.wants(i)) {
      if (part.layout == Layout::kChannels4 && !whole_blocks(part, joined, begin))
        shift_channels(recorder, io.dy[0], io.dx[i], begin, accumulate);
      else
        copy_runs(recorder, io.dy[0].slice, io.dx[i].slice, reversed(runs_of(part, joined, axis_, begin)),
                  accumulate);
    }
    begin += part.shape[axis_];
  }
}

Value concat(const std::vector<Value>& xs, size_t axis) {
  if (xs.empty()) throw Error("[concat] takes at least one input");
  return xs[0].graph().apply1(std::make_shared<Concat>(axis), xs);
}

}  // namespace vkopple
