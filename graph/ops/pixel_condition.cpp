#include "graph/ops/pixel_condition.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/strips.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct PixelConditionPush {
  uint32_t samples;  ///< B·S
  uint32_t slots;    ///< S
  uint32_t shared;   ///< A
  uint32_t pixels;
  uint32_t strips;
  uint32_t accumulate;
};

PixelConditionPush push_of(const Shape& shared, const Shape& points, uint32_t accumulate = 0) {
  const uint32_t pixels = u32(points[2] * points[3]);
  return {.samples = u32(shared[0] * shared[1]),
          .slots = u32(shared[1]),
          .shared = u32(shared[2]),
          .pixels = pixels,
          .strips = pixel_strips(pixels),
          .accumulate = accumulate};
}

/// Vectors of 4 channels that hold shared numbers.
uint32_t shared_blocks(const PixelConditionPush& push) { return u32(blocks4(push.shared)); }

}  // namespace

std::vector<TensorSpec> PixelCondition::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes two inputs");
  const Shape& shared = x[0].shape;
  const Shape& points = x[1].shape;
  require(row_floats(x[0], 3) && row_floats(x[1], 4) && points[0] == shared[0] && points[1] == 3,
          fmt::format("takes row-major numbers (B, S, A) and points (B, 3, H, W), not {} and {}", shared.text(),
                      points.text()));
  return {channels4({shared[0] * shared[1], shared[2] + 4, points[2], points[3]})};
}

Needs PixelCondition::needs(std::span<const TensorSpec> x, const Caps&) const {
  const auto push = push_of(x[0].shape, x[1].shape);
  return {.backward_scratch = uint64_t{16} * push.samples * shared_blocks(push) * push.strips,
          .inputs_for_backward = 0,
          .outputs_for_backward = 0};
}

void PixelCondition::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_of(io.x[0].shape(), io.x[1].shape());
  recorder.dispatch_flat("pixel_condition.forward", words(io.y[0]) / 4,
                         {io.x[0].slice, io.x[1].slice, io.y[0].slice}, push);
}

void PixelCondition::record_backward(Recorder& recorder, const Backward& io) const {
  const Shape& shared = io.x[0].shape();
  const Shape& points = io.x[1].shape();
  if (io.wants(0)) {
    const auto push = push_of(shared, points, io.accumulates(0));
    const uint64_t blocks = uint64_t{push.samples} * shared_blocks(push);
    recorder.dispatch_flat("pixel_condition.strips", blocks * push.strips, {io.dy[0].slice, io.scratch}, push);
    recorder.dispatch_flat("pixel_condition.sums", blocks, {io.scratch, io.dx[0].slice}, push);
  }
  if (io.wants(1)) {
    const auto push = push_of(shared, points, io.accumulates(1));
    recorder.dispatch_flat("pixel_condition.points", uint64_t{push.samples / push.slots} * push.pixels,
                           {io.dy[0].slice, io.dx[1].slice}, push);
  }
}

Value pixel_condition(Value shared, Value points) {
  return points.graph().apply1(std::make_shared<PixelCondition>(), {shared, points});
}

}  // namespace vkopple
