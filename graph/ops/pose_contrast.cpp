#include "graph/ops/pose_contrast.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct PoseContrastPush {
  uint32_t batch;
  uint32_t slots;
  uint32_t bins;
  float most;
  float scale;  ///< −1 / B
  uint32_t wants;
  uint32_t accumulates;  ///< bit i of both speaks of input i
};

PoseContrastPush push_for(const Shape& log_p) {
  return {.batch = u32(log_p[0]),
          .slots = u32(log_p[1]),
          .bins = u32(log_p[2]),
          .most = PoseContrast::kMost,
          .scale = -1.0F / static_cast<float>(log_p[0])};
}

uint64_t objects(const PoseContrastPush& push) { return uint64_t{push.batch} * push.slots; }

}  // namespace

std::vector<TensorSpec> PoseContrast::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 4, "takes four inputs");
  const Shape& p = x[0].shape;
  require(row_floats(x[0], 3) && row_floats(x[1], p) && row_floats(x[2], {p[0], p[1]}) &&
              x[3] == unsigned_ints({p[0]}),
          fmt::format("takes row-major (B, K, b) twice, (B, K) and B unsigned integers, not {}, {}, {} and {}",
                      p.text(), x[1].shape.text(), x[2].shape.text(), x[3].shape.text()));
  return {row_major({1})};
}

Needs PoseContrast::needs(std::span<const TensorSpec> x, const Caps&) const {
  const uint64_t count = words(x[2]);
  return {.forward_scratch = TermSum(count).scratch_bytes(),
          .backward_scratch = count * 4,
          .outputs_for_backward = 0};
}

void PoseContrast::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].shape());
  const TermSum sum(objects(push));
  recorder.dispatch_flat("pose_contrast.forward", sum.count(),
                         {io.x[0].slice, io.x[1].slice, io.x[3].slice, io.x[2].slice, sum.terms(io.scratch)},
                         push, {static_cast<uint32_t>(divergence_)});
  sum.record(recorder, io.scratch, io.y[0].slice, push.scale);
}

void PoseContrast::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[0].shape());
  push.wants = io.wants_mask();
  push.accumulates = io.accumulates_mask();
  const std::vector<uint32_t> divergence{static_cast<uint32_t>(divergence_)};
  recorder.dispatch_flat(
      "pose_contrast.score", objects(push),
      {io.x[0].slice, io.x[1].slice, io.x[3].slice, io.dy[0].slice, io.scratch, io.dx[2].slice}, push,
      divergence);
  if (io.wants(0) || io.wants(1))
    recorder.dispatch_flat("pose_contrast.bins", objects(push) * push.bins,
                           {io.x[0].slice, io.x[1].slice, io.x[3].slice, io.x[2].slice, io.dy[0].slice,
                            io.scratch, io.dx[0].slice, io.dx[1].slice},
                           push, divergence);
}

Value pose_contrast(Value log_p1, Value log_p3, Value q, Value permutation, PoseDivergence divergence) {
  return log_p1.graph().apply1(std::make_shared<PoseContrast>(divergence), {log_p1, log_p3, q, permutation});
}

}  // namespace vkopple
