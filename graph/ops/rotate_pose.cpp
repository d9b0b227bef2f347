#include "graph/ops/rotate_pose.h"

#include "graph/kernels/circular.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

Circle circle_of(const Operand& pose) { return {u32(pose.shape()[0] * pose.shape()[1]), u32(pose.shape()[2])}; }

}  // namespace

std::vector<TensorSpec> RotatePose::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2 && x[0] == x[1] && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32 &&
              x[0].shape.rank() == 3,
          "takes two row-major tensors (B, K, b) of equal shapes");
  return {x[0]};
}

Needs RotatePose::needs(std::span<const TensorSpec>, const Caps&) const { return {}; }

void RotatePose::record_forward(Recorder& recorder, const Forward& io) const {
  circular_log_sum(recorder, io.x[0].slice, io.x[1].slice, io.y[0].slice, circle_of(io.y[0]),
                   Direction::kBackward);
}

void RotatePose::record_backward(Recorder& recorder, const Backward& io) const {
  for (size_t side = 0; side < 2; ++side)
    if (io.wants(side))
      circular_log_sum_gradient(recorder,
                                {.a = io.x[0].slice,
                                 .b = io.x[1].slice,
                                 .y = io.y[0].slice,
                                 .dy = io.dy[0].slice,
                                 .to = io.dx[side].slice,
                                 .of_a = side == 0,
                                 .accumulate = io.accumulates(side)},
                                circle_of(io.y[0]), Direction::kBackward);
}

Value rotate_pose(Value log_p, Value log_g) {
  return log_p.graph().apply1(std::make_shared<RotatePose>(), {log_p, log_g});
}

}  // namespace vkopple
