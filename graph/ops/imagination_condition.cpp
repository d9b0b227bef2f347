#include "graph/ops/imagination_condition.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ConditionPush {
  uint32_t rows;   ///< B·(K+1)
  uint32_t slots;  ///< K
  uint32_t ego;    ///< E
  uint32_t turn;   ///< numbers of velocity and turn each: 2 or 3
  uint32_t want_velocity;
  uint32_t want_turn;
  uint32_t accumulate_velocity;
  uint32_t accumulate_turn;
};

ConditionPush push_of(std::span<const Operand> x) {
  const Shape& turn = x[2].shape();
  return {.rows = u32(turn[0] * (turn[1] + 1)),
          .slots = u32(turn[1]),
          .ego = u32(x[0].shape()[1]),
          .turn = u32(turn[2])};
}

}  // namespace

std::vector<TensorSpec> ImaginationCondition::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  const std::string message = fmt::format(
      "takes row-major ego-motion (B, E), velocity (B, K, 3) and turn (B, K, 2 or 3), not {}, {}, {}",
      x[0].shape.text(), x[1].shape.text(), x[2].shape.text());
  require(row_floats(x[1], 3) && x[1].shape[2] == 3, message);
  require(row_floats(x[0], 2) && x[0].shape[0] == x[1].shape[0], message);
  const int64_t turn = x[2].shape.rank() == 3 ? x[2].shape[2] : 0;
  require((turn == 2 || turn == 3) && row_floats(x[2], x[1].shape.with(2, turn)), message);
  return {row_major({x[1].shape[0], x[1].shape[1] + 1, x[0].shape[1] + 2 * turn})};
}

Needs ImaginationCondition::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void ImaginationCondition::record_forward(Recorder& recorder, const Forward& io) const {
  const ConditionPush push = push_of(io.x);
  recorder.dispatch_flat("imagination_condition.forward", push.rows,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.y[0].slice}, push);
}

void ImaginationCondition::record_backward(Recorder& recorder, const Backward& io) const {
  ConditionPush push = push_of(io.x);
  push.want_velocity = io.wants(1) ? 1 : 0;
  push.want_turn = io.wants(2) ? 1 : 0;
  push.accumulate_velocity = io.accumulates(1);
  push.accumulate_turn = io.accumulates(2);
  recorder.dispatch_flat("imagination_condition.backward", push.rows,
                         {io.dy[0].slice, io.dx[1].slice, io.dx[2].slice}, push);
}

Value imagination_condition(Value ego, Value velocity, Value turn) {
  return ego.graph().apply1(std::make_shared<ImaginationCondition>(), {ego, velocity, turn});
}

}  // namespace vkopple
