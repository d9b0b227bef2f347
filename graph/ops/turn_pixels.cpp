#include "graph/ops/turn_pixels.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/rigid_motion.h"
#include "graph/kernels/strips.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

enum Input : size_t { kPoints, kLocation, kVelocity, kTurn, kM23 };

struct MotionPush {
  RigidMotion sizes;
  uint32_t strips;
  uint32_t want_location;
  uint32_t want_velocity;
  uint32_t want_turn;
  uint32_t accumulate_location;
  uint32_t accumulate_velocity;
  uint32_t accumulate_turn;
};

RigidMotion sizes_of(const Shape& points, const Shape& turn) {
  return {.images = u32(points[0]), .slots = u32(turn[1]), .pixels = u32(points[2] * points[3])};
}
RigidMotion sizes_of(std::span<const Operand> x) { return sizes_of(x[kPoints].shape(), x[kTurn].shape()); }

MotionSlices motion_of(std::span<const Operand> x) {
  return {x[kLocation].slice, x[kVelocity].slice, x[kTurn].slice, x[kM23].slice};
}

/// What a strip leaves: sums of 3 + 9 numbers.
constexpr uint64_t kStripBytes = 3 * 16;

}  // namespace

std::vector<TensorSpec> TurnPixels::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 5, "takes five inputs");
  const Shape& points = x[kPoints].shape;
  const Shape& turn = x[kTurn].shape;
  require(row_floats(x[kPoints], 4) && points[1] == 3 && row_floats(x[kTurn], 4) && turn[0] == points[0] &&
              turn[2] == 3 && turn[3] == 3,
          fmt::format("takes row-major points (B, 3, H, W) and rotations (B, K, 3, 3), not {} and {}",
                      points.text(), turn.text()));
  const Shape vectors{points[0], turn[1], 3};
  require(
      row_floats(x[kLocation], vectors) && row_floats(x[kVelocity], vectors) &&
          row_floats(x[kM23], {points[0], 4, 4}),
      fmt::format("takes row-major locations and velocities {} and camera motions (B, 4, 4), not {}, {} and {}",
                  vectors.text(), x[kLocation].shape.text(), x[kVelocity].shape.text(), x[kM23].shape.text()));
  return {row_major({points[0], turn[1] + 1, 3, points[2], points[3]})};
}

Needs TurnPixels::needs(std::span<const TensorSpec> x, const Caps&) const {
  const RigidMotion sizes = sizes_of(x[kPoints].shape, x[kTurn].shape);
  return {.backward_scratch = kStripBytes * sizes.images * sizes.slots * pixel_strips(sizes.pixels),
          .inputs_for_backward = 1U << kPoints | 1U << kLocation | 1U << kTurn | 1U << kM23,
          .outputs_for_backward = 0};
}

void TurnPixels::record_forward(Recorder& recorder, const Forward& io) const {
  record_moved(recorder, sizes_of(io.x), Turns::kMatrices, io.x[kPoints].slice, motion_of(io.x), io.y[0].slice);
}

void TurnPixels::record_backward(Recorder& recorder, const Backward& io) const {
  if (io.wants(kPoints))
    record_moved_dpoints(recorder, sizes_of(io.x), Turns::kMatrices, motion_of(io.x), io.dy[0].slice,
                         io.dx[kPoints].slice, io.accumulates(kPoints) != 0);
  if (io.wants(kLocation) || io.wants(kVelocity) || io.wants(kTurn)) record_motion_gradients(recorder, io);
}

void TurnPixels::record_motion_gradients(Recorder& recorder, const Backward& io) const {
  const RigidMotion sizes = sizes_of(io.x);
  const MotionPush push{.sizes = sizes,
                        .strips = pixel_strips(sizes.pixels),
                        .want_location = io.wants(kLocation) ? 1U : 0U,
                        .want_velocity = io.wants(kVelocity) ? 1U : 0U,
                        .want_turn = io.wants(kTurn) ? 1U : 0U,
                        .accumulate_location = io.accumulates(kLocation),
                        .accumulate_velocity = io.accumulates(kVelocity),
                        .accumulate_turn = io.accumulates(kTurn)};
  const uint64_t objects = uint64_t{sizes.images} * sizes.slots;
  recorder.dispatch_flat(
      "turn_pixels.strips", objects * push.strips,
      {io.x[kLocation].slice, io.x[kM23].slice, io.x[kPoints].slice, io.dy[0].slice, io.scratch}, push);
  recorder.dispatch_flat(
      "turn_pixels.sums", objects,
      {io.x[kTurn].slice, io.scratch, io.dx[kLocation].slice, io.dx[kVelocity].slice, io.dx[kTurn].slice},
      push);
}

Value turn_pixels(Value points, Value location, Value velocity, Value turn, Value m23) {
  return points.graph().apply1(std::make_shared<TurnPixels>(), {points, location, velocity, turn, m23});
}

}  // namespace vkopple
