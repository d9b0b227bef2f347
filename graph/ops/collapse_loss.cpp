#include "graph/ops/collapse_loss.h"

#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct CollapseLossPush {
  uint32_t batch;
  uint32_t slots;
  float scale;  ///< -1 / B
  uint32_t wants;
  uint32_t accumulates;  ///< bit i of both speaks of input i
};

CollapseLossPush push_for(const Shape& q) {
  return {.batch = u32(q[0]), .slots = u32(q[1]), .scale = -1.0F / static_cast<float>(q[0])};
}

}  // namespace

std::vector<TensorSpec> CollapseLoss::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 4, "takes four inputs");
  for (const TensorSpec& spec : x.first(3))
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32, "takes row-major floats");
  const Shape& q = x[2].shape;
  require(q.rank() == 2 && x[0].shape == Shape{q[0], q[1], 3} && x[1].shape == x[0].shape,
          "takes (B, K, 3) twice and (B, K), not " + x[0].shape.text() + ", " + x[1].shape.text() + " and " +
              q.text());
  require(x[3] == unsigned_ints({q[0]}),
          "takes a permutation of " + std::to_string(q[0]) + " unsigned integers, not " + x[3].shape.text());
  return {row_major({1})};
}

Needs CollapseLoss::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.forward_scratch = TermSum(words(x[2])).scratch_bytes(), .outputs_for_backward = 0};
}

void CollapseLoss::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[2].shape());
  const TermSum sum(words(io.x[2]));
  recorder.dispatch_flat("collapse_loss.forward", sum.count(),
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.x[3].slice, sum.terms(io.scratch)},
                         push);
  sum.record(recorder, io.scratch, io.y[0].slice, push.scale);
}

void CollapseLoss::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[2].shape());
  push.wants = io.wants_mask();
  push.accumulates = io.accumulates_mask();
  recorder.dispatch_flat("collapse_loss.backward", words(io.x[2]),
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.x[3].slice, io.dy[0].slice,
                          io.dx[0].slice, io.dx[1].slice, io.dx[2].slice},
                         push);
}

Value collapse_loss(Value location1, Value location3, Value q, Value permutation) {
  return location1.graph().apply1(std::make_shared<CollapseLoss>(), {location1, location3, q, permutation});
}

}  // namespace vkopple
