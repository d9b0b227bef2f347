#include "graph/ops/imagination_condition.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ConditionPush {
  uint32_t rows;   ///< B·(K+1)
  uint32_t slots;  ///< K
  uint32_t want_velocity;
  uint32_t want_direction;
  uint32_t accumulate_velocity;
  uint32_t accumulate_direction;
};

ConditionPush push_of(const Operand& condition) {
  const Shape& shape = condition.shape();
  return {.rows = u32(shape[0] * shape[1]), .slots = u32(shape[1] - 1)};
}

}  // namespace

std::vector<TensorSpec> ImaginationCondition::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  const std::string message = fmt::format(
      "takes row-major ego-motion (B, 3), velocity (B, K, 3) and direction (B, K, 2), not {}, {}, {}",
      x[0].shape.text(), x[1].shape.text(), x[2].shape.text());
  require(row_floats(x[1], 3) && x[1].shape[2] == 3, message);
  require(row_floats(x[0], {x[1].shape[0], 3}) && row_floats(x[2], x[1].shape.with(2, 2)), message);
  return {row_major({x[1].shape[0], x[1].shape[1] + 1, 7})};
}

Needs ImaginationCondition::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void ImaginationCondition::record_forward(Recorder& recorder, const Forward& io) const {
  const ConditionPush push = push_of(io.y[0]);
  recorder.dispatch_flat("imagination_condition.forward", push.rows,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.y[0].slice}, push);
}

void ImaginationCondition::record_backward(Recorder& recorder, const Backward& io) const {
  ConditionPush push = push_of(io.dy[0]);
  push.want_velocity = io.wants(1) ? 1 : 0;
  push.want_direction = io.wants(2) ? 1 : 0;
  push.accumulate_velocity = io.accumulates(1);
  push.accumulate_direction = io.accumulates(2);
  recorder.dispatch_flat("imagination_condition.backward", push.rows,
                         {io.dy[0].slice, io.dx[1].slice, io.dx[2].slice}, push);
}

Value imagination_condition(Value ego, Value velocity, Value direction) {
  return ego.graph().apply1(std::make_shared<ImaginationCondition>(), {ego, velocity, direction});
}

}  // namespace vkopple
