#include "graph/ops/move_pixels.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/rigid_motion.h"
#include "graph/kernels/strips.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

enum Input : size_t { kPoints, kLocation, kVelocity, kOmega, kM23 };

struct MotionPush {
  RigidMotion sizes;
  uint32_t strips;
  uint32_t want_location;
  uint32_t want_velocity;
  uint32_t want_omega;
  uint32_t accumulate_location;
  uint32_t accumulate_velocity;
  uint32_t accumulate_omega;
};

RigidMotion sizes_of(const Shape& points, const Shape& omega) {
  return {.images = u32(points[0]), .slots = u32(omega[1]), .pixels = u32(points[2] * points[3])};
}

MotionSlices motion_of(std::span<const Operand> x) {
  return {x[kLocation].slice, x[kVelocity].slice, x[kOmega].slice, x[kM23].slice};
}

}  // namespace

std::vector<TensorSpec> MovePixels::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 5, "takes five inputs");
  require(row_floats(x[kPoints], 4) && x[kPoints].shape[1] == 3,
          fmt::format("takes row-major points (B, 3, H, W), not {}", x[kPoints].shape.text()));
  const Shape& points = x[kPoints].shape;
  require(row_floats(x[kOmega], 2) && x[kOmega].shape[0] == points[0],
          fmt::format("takes row-major rotations (B, K), not {}", x[kOmega].shape.text()));
  const Shape vectors{points[0], x[kOmega].shape[1], 3};
  require(row_floats(x[kLocation], vectors) && row_floats(x[kVelocity], vectors),
          fmt::format("takes row-major locations and velocities {}, not {} and {}", vectors.text(),
                      x[kLocation].shape.text(), x[kVelocity].shape.text()));
  require(row_floats(x[kM23], {points[0], 4, 4}),
          fmt::format("takes row-major camera motions (B, 4, 4), not {}", x[kM23].shape.text()));
  return {row_major({points[0], vectors[1] + 1, 3, points[2], points[3]})};
}

Needs MovePixels::needs(std::span<const TensorSpec> x, const Caps&) const {
  const RigidMotion sizes = sizes_of(x[kPoints].shape, x[kOmega].shape);
  return {.backward_scratch = uint64_t{16} * sizes.images * sizes.slots * pixel_strips(sizes.pixels),
          .inputs_for_backward = 1U << kPoints | 1U << kLocation | 1U << kOmega | 1U << kM23,
          .outputs_for_backward = 0};
}

void MovePixels::record_forward(Recorder& recorder, const Forward& io) const {
  record_moved(recorder, sizes_of(io.x[kPoints].shape(), io.x[kOmega].shape()), Turns::kAngles,
               io.x[kPoints].slice, motion_of(io.x), io.y[0].slice);
}

void MovePixels::record_backward(Recorder& recorder, const Backward& io) const {
  if (io.wants(kPoints))
    record_moved_dpoints(recorder, sizes_of(io.x[kPoints].shape(), io.x[kOmega].shape()), Turns::kAngles,
                         motion_of(io.x), io.dy[0].slice, io.dx[kPoints].slice, io.accumulates(kPoints) != 0);
  if (io.wants(kLocation) || io.wants(kVelocity) || io.wants(kOmega)) record_motion_gradients(recorder, io);
}

void MovePixels::record_motion_gradients(Recorder& recorder, const Backward& io) const {
  const RigidMotion sizes = sizes_of(io.x[kPoints].shape(), io.x[kOmega].shape());
  const uint32_t strips = pixel_strips(sizes.pixels);
  const MotionPush push{.sizes = sizes,
                        .strips = strips,
                        .want_location = io.wants(kLocation) ? 1U : 0U,
                        .want_velocity = io.wants(kVelocity) ? 1U : 0U,
                        .want_omega = io.wants(kOmega) ? 1U : 0U,
                        .accumulate_location = io.accumulates(kLocation),
                        .accumulate_velocity = io.accumulates(kVelocity),
                        .accumulate_omega = io.accumulates(kOmega)};
  const uint64_t objects = static_cast<uint64_t>(sizes.images) * sizes.slots;
  recorder.dispatch_flat("move_pixels_motion.strips", objects * strips,
                         {io.x[kLocation].slice, io.x[kOmega].slice, io.x[kM23].slice, io.x[kPoints].slice,
                          io.dy[0].slice, io.scratch},
                         push);
  recorder.dispatch_flat(
      "move_pixels_motion.sums", objects,
      {io.x[kOmega].slice, io.scratch, io.dx[kLocation].slice, io.dx[kVelocity].slice, io.dx[kOmega].slice},
      push);
}

Value move_pixels(Value points, Value location, Value velocity, Value omega, Value m23) {
  return points.graph().apply1(std::make_shared<MovePixels>(), {points, location, velocity, omega, m23});
}

}  // namespace vkopple
