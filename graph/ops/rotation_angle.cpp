#include "graph/ops/rotation_angle.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct RotationAnglePush {
  uint32_t slots;
  uint32_t wants_direction;
  uint32_t wants_q;
  uint32_t accumulate_direction;
  uint32_t accumulate_q;
};

}  // namespace

std::vector<TensorSpec> RotationAngle::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2 && x[0].layout == Layout::kRowMajor && x[1].layout == Layout::kRowMajor,
          "takes directions and q, row-major");
  const Shape& direction = x[0].shape;
  const Shape& q = x[1].shape;
  require(q.rank() == 2 && direction == Shape({q[0], q[1], 2}),
          fmt::format("takes directions (B, K, 2) and q (B, K), not {} and {}", direction.text(), q.text()));
  return {x[1]};
}

Needs RotationAngle::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.outputs_for_backward = 0};
}

void RotationAngle::record_forward(Recorder& recorder, const Forward& io) const {
  const RotationAnglePush push{words(io.y[0]), 0, 0, 0, 0};
  recorder.dispatch_flat("rotation_angle.forward", push.slots, {io.x[0].slice, io.x[1].slice, io.y[0].slice},
                         push);
}

void RotationAngle::record_backward(Recorder& recorder, const Backward& io) const {
  const RotationAnglePush push{words(io.dy[0]), io.wants(0), io.wants(1), io.accumulates(0), io.accumulates(1)};
  recorder.dispatch_flat("rotation_angle.backward", push.slots,
                         {io.x[0].slice, io.x[1].slice, io.dy[0].slice, io.dx[0].slice, io.dx[1].slice}, push);
}

Value rotation_angle(Value direction, Value q) {
  return q.graph().apply1(std::make_shared<RotationAngle>(), {direction, q});
}

}  // namespace vkopple
