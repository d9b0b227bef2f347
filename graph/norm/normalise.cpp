#include "graph/norm/normalise.h"

#include <algorithm>
#include <bit>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

// Strips of a channel block: enough to fill the device, few enough for the second stage. A lane's item costs
// some 3 ns on lavapipe, a workgroup 0.4 µs, so 64 are worth an invocation there; 1024 in a compensated sum of
// fours keep float32's digits.
constexpr uint32_t kStripsOnCpu = 256;
constexpr uint32_t kStripsOnGpu = 512;
constexpr uint32_t kFewestItemsOnCpu = 64;
constexpr uint32_t kFewestItemsOnGpu = 16;
constexpr uint32_t kMostItems = 1024;
constexpr uint32_t kPixelsEach = 16;
// Rows of a workgroup of norm_apply where it stores rows. A workgroup costs as much as nine rows, and 32
// rows half a second to compile.
constexpr uint32_t kRowsEach = 8;
constexpr uint32_t kRowsEachOfLongWork = 32;

uint32_t divide_up(uint32_t a, uint32_t b) { return (a + b - 1) / b; }

/// log2 of a stride: a subgroup reads a contiguous run, of no more pixels than there are.
uint32_t lanes_for(uint32_t pixels, const Caps& caps) {
  const uint32_t most = std::clamp(caps.subgroup_size, 4U, 64U);
  return static_cast<uint32_t>(std::bit_width(std::min(std::bit_floor(most), std::bit_ceil(pixels)))) - 1;
}

}  // namespace

/// As shaders/include/norm_walk.glsl has it.
struct Normalise::WalkPush {
  NormStrips strips;
  uint32_t pixels;
  uint32_t per_group;
  uint32_t step_pixel;
  uint32_t step_at;
  uint32_t wrap;
  float slope;
  uint32_t stream;
  uint32_t threshold;
  float scale;
};

/// As shaders/norm/norm_apply.comp has it.
struct Normalise::ApplyPush {
  uint32_t pixels;
  uint32_t strips;
  uint32_t lanes;
  uint32_t each;
  uint32_t blocks;
  uint32_t per_group;
  float slope;
  uint32_t stream;
  uint32_t threshold;
  float scale;
  uint32_t accumulate;
};

Normalise::Normalise(const Shape& x, int64_t groups, const NormSurround& surround, const Caps& caps)
    : surround_(surround),
      samples_(u32(x[0])),
      pixels_(u32(x[2] * x[3])),
      per_group_(u32(x[0] / groups)),
      lanes_(lanes_for(pixels_, caps)),
      apply_each_(std::clamp(pixels_ >> lanes_, 1U, kPixelsEach)),
      strip_workgroup_(caps.cpu() ? std::clamp(caps.subgroup_size, 4U, 64U) : 64),
      finish_workgroup_(caps.cpu() ? std::clamp(caps.subgroup_size, 4U, 64U) : 64),
      flat_workgroup_(caps.flat_workgroup()) {
  const uint32_t items = per_group_ * pixels_;
  const uint32_t lanes = lanes_for(items, caps);
  const uint32_t target = caps.cpu() ? kStripsOnCpu : kStripsOnGpu;
  const uint32_t each =
      std::clamp(divide_up(items, target), caps.cpu() ? kFewestItemsOnCpu : kFewestItemsOnGpu, kMostItems);
  strips_ = {.items = items,
             .strips = divide_up(items, each << lanes) << lanes,
             .lanes = lanes,
             .each = each,
             .blocks = u32(blocks4(x[1])),
             .groups = u32(groups),
             .channels = u32(x[1])};
}

uint64_t Normalise::partial_bytes() const {
  return uint64_t{strips_.groups} * strips_.blocks * strips_.strips * 48;
}

uint64_t Normalise::sum_bytes() const {
  return uint64_t{strips_.groups} * strips_.blocks * strips_.strips * 32;
}

TensorSpec Normalise::table() const { return row_major({int64_t{strips_.groups} * strips_.blocks * 16}); }

Normalise::WalkPush Normalise::walk_push() const {
  const uint32_t stride = 1U << strips_.lanes;
  const uint32_t sample = strips_.blocks * pixels_;
  return {.strips = strips_,
          .pixels = pixels_,
          .per_group = per_group_,
          .step_pixel = stride % pixels_,
          .step_at = stride / pixels_ * sample + stride % pixels_,
          .wrap = sample - pixels_,
          .slope = surround_.slope,
          .stream = surround_.stream,
          .threshold = surround_.dropout.threshold,
          .scale = surround_.dropout.scale};
}

Normalise::ApplyPush Normalise::apply_push(uint32_t accumulate) const {
  return {.pixels = pixels_,
          .strips = divide_up(pixels_, apply_each_ << lanes_) << lanes_,
          .lanes = lanes_,
          .each = apply_each_,
          .blocks = strips_.blocks,
          .per_group = per_group_,
          .slope = surround_.slope,
          .stream = surround_.stream,
          .threshold = surround_.dropout.threshold,
          .scale = surround_.dropout.scale,
          .accumulate = accumulate};
}

Groups Normalise::strip_groups() const {
  return {divide_up(strips_.strips, strip_workgroup_), strips_.blocks, strips_.groups};
}

void Normalise::record_statistics(Recorder& recorder, const Slice& x, const Slice& partials) const {
  recorder.dispatch("norm_statistics", {strip_workgroup_}, {x, partials}, walk_push(), strip_groups());
}

void Normalise::record_reduce(Recorder& recorder, const Slice& random, const Slice& x, const Slice& dy,
                              const Slice& table, const Slice& partials) const {
  recorder.dispatch("norm_reduce", {strip_workgroup_, surround_.drops ? 1U : 0U},
                    {random, x, dy, table, partials}, walk_push(), strip_groups());
}

void Normalise::dispatch_apply(Recorder& recorder, const char* shader, std::initializer_list<Slice> bindings,
                               uint32_t accumulate) const {
  const ApplyPush push = apply_push(accumulate);
  const uint32_t drops = surround_.drops ? 1U : 0U;
  const Caps& caps = recorder.caps();
  const uint32_t lanes = caps.subgroup_size;
  if (caps.row_stores && pixels_ >= lanes && pixels_ % 2 == 0) {
    const uint32_t rows = std::min(caps.long_work ? kRowsEachOfLongWork : kRowsEach, divide_up(pixels_, lanes));
    recorder.dispatch(shader, {lanes, drops, rows}, bindings, push,
                      {divide_up(pixels_, lanes * rows), strips_.blocks, samples_});
    return;
  }
  const uint32_t local = std::min(flat_workgroup_, std::bit_ceil(push.strips));
  recorder.dispatch(shader, {local, drops}, bindings, push,
                    {divide_up(push.strips, local), strips_.blocks, samples_});
}

void Normalise::record_apply(Recorder& recorder, const Slice& random, const Slice& x, const Slice& table,
                             const Slice& y) const {
  dispatch_apply(recorder, "norm_apply.forward", {random, x, table, y}, 0);
}

void Normalise::record_apply_backward(Recorder& recorder, const Slice& random, const Slice& x,
                                      const Slice& coefficients, const Slice& dy, const Slice& dx,
                                      uint32_t accumulate) const {
  dispatch_apply(recorder, "norm_apply.backward", {random, x, coefficients, dy, dx, dx}, accumulate);
}

}  // namespace vkopple
