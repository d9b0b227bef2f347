#include "graph/ops/rotation_posterior.h"

#include "graph/kernels/circular.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct RotationPosteriorPush {
  uint32_t rows;
  uint32_t bins;
  float prior_kappa;
};

Circle circle_of(const Operand& pose) { return {u32(pose.shape()[0] * pose.shape()[1]), u32(pose.shape()[2])}; }

}  // namespace

std::vector<TensorSpec> RotationPosterior::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2 && x[0] == x[1] && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32 &&
              x[0].shape.rank() == 3,
          "takes two row-major tensors (B, K, b) of equal shapes");
  return {x[0], row_major({x[0].shape[0], x[0].shape[1], 2})};
}

Needs RotationPosterior::needs(std::span<const TensorSpec> x, const Caps&) const {
  // Saved: the correlation, before prior and normalisation. In inference it lies in the scratch.
  return {.saved = {x[0]},
          .forward_scratch = x[0].bytes(),
          .backward_scratch = x[0].bytes(),
          .outputs_for_backward = 1};
}

void RotationPosterior::record_forward(Recorder& recorder, const Forward& io) const {
  const Slice correlation = io.saved[0] ? io.saved[0].slice : io.scratch;
  const Circle circle = circle_of(io.x[0]);
  circular_log_sum(recorder, io.x[0].slice, io.x[1].slice, correlation, circle, Direction::kForward);
  recorder.dispatch_flat("rotation_posterior.forward", circle.rows, {correlation, io.y[0].slice, io.y[1].slice},
                         RotationPosteriorPush{circle.rows, circle.bins, prior_kappa_});
}

void RotationPosterior::record_backward(Recorder& recorder, const Backward& io) const {
  const Circle circle = circle_of(io.x[0]);
  recorder.dispatch_flat("rotation_posterior.backward", circle.rows,
                         {io.y[0].slice, io.dy[0].slice, io.dy[1].slice, io.scratch},
                         RotationPosteriorPush{circle.rows, circle.bins, prior_kappa_});
  for (size_t side = 0; side < 2; ++side)
    if (io.wants(side))
      circular_log_sum_gradient(recorder,
                                {.a = io.x[0].slice,
                                 .b = io.x[1].slice,
                                 .y = io.saved[0].slice,
                                 .dy = io.scratch,
                                 .to = io.dx[side].slice,
                                 .of_a = side == 0,
                                 .accumulate = io.accumulates(side)},
                                circle, Direction::kForward);
}

std::vector<Value> rotation_posterior(Value log_p1, Value log_p2, float prior_kappa) {
  return log_p1.graph().apply(std::make_shared<RotationPosterior>(prior_kappa), {log_p1, log_p2});
}

}  // namespace vkopple
