#include "graph/ops/pose_loss.h"

#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct PoseLossPush {
  uint32_t objects;
  uint32_t bins;
  float scale;  ///< 1 / B
  uint32_t wants;
  uint32_t accumulates;  ///< bit i of both speaks of input i
};

PoseLossPush push_for(const Shape& log_p) {
  return {
      .objects = u32(log_p[0] * log_p[1]), .bins = u32(log_p[2]), .scale = 1.0F / static_cast<float>(log_p[0])};
}

}  // namespace

std::vector<TensorSpec> PoseLoss::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  for (const TensorSpec& spec : x)
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32, "takes row-major floats");
  const Shape& p = x[0].shape;
  require(p.rank() == 3 && x[1].shape == p && x[2].shape == Shape{p[0], p[1]},
          "takes (B, K, b) twice and (B, K), not " + p.text() + ", " + x[1].shape.text() + " and " +
              x[2].shape.text());
  return {row_major({1})};
}

Needs PoseLoss::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.forward_scratch = TermSum(words(x[2])).scratch_bytes(), .outputs_for_backward = 0};
}

void PoseLoss::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].shape());
  const TermSum sum(push.objects);
  recorder.dispatch_flat("pose_loss.forward", push.objects,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, sum.terms(io.scratch)}, push,
                         {static_cast<uint32_t>(divergence_)});
  sum.record(recorder, io.scratch, io.y[0].slice, push.scale);
}

void PoseLoss::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[0].shape());
  push.wants = io.wants_mask();
  push.accumulates = io.accumulates_mask();
  const auto divergence = static_cast<uint32_t>(divergence_);
  if (io.wants(0) || io.wants(1))
    recorder.dispatch_flat(
        "pose_loss.bins", uint64_t{push.objects} * push.bins,
        {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.dy[0].slice, io.dx[0].slice, io.dx[1].slice}, push,
        {divergence});
  if (io.wants(2))
    recorder.dispatch_flat("pose_loss.score", push.objects,
                           {io.x[0].slice, io.x[1].slice, io.dy[0].slice, io.dx[2].slice}, push, {divergence});
}

Value pose_loss(Value log_p3, Value log_pbar, Value q, PoseDivergence divergence) {
  return log_p3.graph().apply1(std::make_shared<PoseLoss>(divergence), {log_p3, log_pbar, q});
}

}  // namespace vkopple
