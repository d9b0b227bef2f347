#include "graph/ops/move_pixels.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/rigid_motion.h"
#include "graph/kernels/strips.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

enum Input : size_t { kPoints, kLocation, kVelocity, kTurns, kM23 };

struct MotionPush {
  RigidMotion sizes;
  uint32_t strips;
  uint32_t want_location;
  uint32_t want_velocity;
  uint32_t want_turns;
  uint32_t accumulate_location;
  uint32_t accumulate_velocity;
  uint32_t accumulate_turns;
};

RigidMotion sizes_of(const Shape& points, const Shape& turns) {
  return {.images = u32(points[0]), .slots = u32(turns[1]), .pixels = u32(points[2] * points[3])};
}
RigidMotion sizes_of(std::span<const Operand> x) { return sizes_of(x[kPoints].shape(), x[kTurns].shape()); }

Turns kind_of(const Shape& turns) { return turns.rank() == 2 ? Turns::kAngles : Turns::kMatrices; }
Turns kind_of(std::span<const Operand> x) { return kind_of(x[kTurns].shape()); }

MotionSlices motion_of(std::span<const Operand> x) {
  return {x[kLocation].slice, x[kVelocity].slice, x[kTurns].slice, x[kM23].slice};
}

/// What a strip leaves: sums of 3 numbers and one for the angle, or 9 for the matrix.
uint64_t strip_bytes(Turns turns) { return turns == Turns::kAngles ? 16 : 3 * 16; }

}  // namespace

std::vector<TensorSpec> MovePixels::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 5, "takes five inputs");
  const Shape& points = x[kPoints].shape;
  const Shape& turns = x[kTurns].shape;
  require(row_floats(x[kPoints], 4) && points[1] == 3,
          fmt::format("takes row-major points (B, 3, H, W), not {}", points.text()));
  require(turns.rank() >= 2 && (row_floats(x[kTurns], Shape{points[0], turns[1]}) ||
                                row_floats(x[kTurns], Shape{points[0], turns[1], 3, 3})),
          fmt::format("takes row-major angles (B, K) or rotations (B, K, 3, 3), not {}", turns.text()));
  const Shape vectors{points[0], turns[1], 3};
  require(row_floats(x[kLocation], vectors) && row_floats(x[kVelocity], vectors),
          fmt::format("takes row-major locations and velocities {}, not {} and {}", vectors.text(),
                      x[kLocation].shape.text(), x[kVelocity].shape.text()));
  require(row_floats(x[kM23], {points[0], 4, 4}),
          fmt::format("takes row-major camera motions (B, 4, 4), not {}", x[kM23].shape.text()));
  return {row_major({points[0], turns[1] + 1, 3, points[2], points[3]})};
}

Needs MovePixels::needs(std::span<const TensorSpec> x, const Caps&) const {
  const RigidMotion sizes = sizes_of(x[kPoints].shape, x[kTurns].shape);
  const uint64_t strips = uint64_t{sizes.images} * sizes.slots * pixel_strips(sizes.pixels);
  return {.backward_scratch = strip_bytes(kind_of(x[kTurns].shape)) * strips,
          .inputs_for_backward = 1U << kPoints | 1U << kLocation | 1U << kTurns | 1U << kM23,
          .outputs_for_backward = 0};
}

void MovePixels::record_forward(Recorder& recorder, const Forward& io) const {
  record_moved(recorder, sizes_of(io.x), kind_of(io.x), io.x[kPoints].slice, motion_of(io.x), io.y[0].slice);
}

void MovePixels::record_backward(Recorder& recorder, const Backward& io) const {
  if (io.wants(kPoints))
    record_moved_dpoints(recorder, sizes_of(io.x), kind_of(io.x), motion_of(io.x), io.dy[0].slice,
                         io.dx[kPoints].slice, io.accumulates(kPoints) != 0);
  if (io.wants(kLocation) || io.wants(kVelocity) || io.wants(kTurns)) record_motion_gradients(recorder, io);
}

void MovePixels::record_motion_gradients(Recorder& recorder, const Backward& io) const {
  const RigidMotion sizes = sizes_of(io.x);
  const MotionPush push{.sizes = sizes,
                        .strips = pixel_strips(sizes.pixels),
                        .want_location = io.wants(kLocation) ? 1U : 0U,
                        .want_velocity = io.wants(kVelocity) ? 1U : 0U,
                        .want_turns = io.wants(kTurns) ? 1U : 0U,
                        .accumulate_location = io.accumulates(kLocation),
                        .accumulate_velocity = io.accumulates(kVelocity),
                        .accumulate_turns = io.accumulates(kTurns)};
  const uint64_t objects = uint64_t{sizes.images} * sizes.slots;
  const bool angles = kind_of(io.x) == Turns::kAngles;
  recorder.dispatch_flat(angles ? "move_pixels_motion.strips" : "move_pixels_motion.strips_turns",
                         objects * push.strips,
                         {io.x[kLocation].slice, io.x[kTurns].slice, io.x[kM23].slice, io.x[kPoints].slice,
                          io.dy[0].slice, io.scratch},
                         push);
  recorder.dispatch_flat(
      angles ? "move_pixels_motion.sums" : "move_pixels_motion.sums_turns", objects,
      {io.x[kTurns].slice, io.scratch, io.dx[kLocation].slice, io.dx[kVelocity].slice, io.dx[kTurns].slice},
      push);
}

Value move_pixels(Value points, Value location, Value velocity, Value turns, Value m23) {
  return points.graph().apply1(std::make_shared<MovePixels>(), {points, location, velocity, turns, m23});
}

}  // namespace vkopple
