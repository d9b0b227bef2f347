#include "graph/ops/move_background.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/rigid_motion.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

RigidMotion sizes_of(const Shape& moved) {
  return {.images = u32(moved[0]), .slots = 0, .pixels = u32(moved[3] * moved[4])};
}

MotionSlices motion_of(const Operand& m23) {
  return {.location = {}, .velocity = {}, .turn = {}, .m23 = m23.slice};
}

}  // namespace

std::vector<TensorSpec> MoveBackground::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes two inputs");
  const Shape& points = x[0].shape;
  require(row_floats(x[0], 4) && points[1] == 3 && row_floats(x[1], {points[0], 4, 4}),
          fmt::format("takes row-major points (B, 3, H, W) and camera motions (B, 4, 4), not {} and {}",
                      points.text(), x[1].shape.text()));
  return {row_major({points[0], 1, 3, points[2], points[3]})};
}

Needs MoveBackground::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 2, .outputs_for_backward = 0};
}

void MoveBackground::record_forward(Recorder& recorder, const Forward& io) const {
  record_moved(recorder, sizes_of(io.y[0].shape()), Turns::kAngles, io.x[0].slice, motion_of(io.x[1]),
               io.y[0].slice);
}

void MoveBackground::record_backward(Recorder& recorder, const Backward& io) const {
  record_moved_dpoints(recorder, sizes_of(io.dy[0].shape()), Turns::kAngles, motion_of(io.x[1]), io.dy[0].slice,
                       io.dx[0].slice, io.accumulates(0) != 0);
}

Value move_background(Value points, Value m23) {
  return points.graph().apply1(std::make_shared<MoveBackground>(), {points, m23});
}

}  // namespace vkopple
