#include "graph/ops/smoothness_loss.h"

#include "graph/kernels/expect.h"
#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct SmoothnessPush {
  uint32_t count;  ///< invocations: rows of pixels forward, pixels backward
  uint32_t height;
  uint32_t width;
  float scale;  ///< 1 / B forward, 2 / B backward
  uint32_t accumulate;
};

uint32_t rows_of(const Shape& masks) { return u32(masks[0] * masks[1] * masks[2]); }

SmoothnessPush push_for(const Shape& masks, uint32_t count, float scale, uint32_t accumulate) {
  return {.count = count,
          .height = u32(masks[2]),
          .width = u32(masks[3]),
          .scale = scale / static_cast<float>(masks[0]),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> SmoothnessLoss::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && row_floats(x[0], 4), "takes row-major masks (B, S, H, W)");
  return {row_major({1})};
}

Needs SmoothnessLoss::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.forward_scratch = TermSum(rows_of(x[0].shape)).scratch_bytes(), .outputs_for_backward = 0};
}

void SmoothnessLoss::record_forward(Recorder& recorder, const Forward& io) const {
  const Shape& masks = io.x[0].shape();
  const TermSum sum(rows_of(masks));
  const auto push = push_for(masks, rows_of(masks), 1, 0);
  recorder.dispatch_flat("smoothness_loss.forward", push.count, {io.x[0].slice, sum.terms(io.scratch)}, push);
  sum.record(recorder, io.scratch, io.y[0].slice, push.scale);
}

void SmoothnessLoss::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_for(io.x[0].shape(), words(io.x[0]), 2, io.accumulates(0));
  recorder.dispatch_flat("smoothness_loss.backward", push.count,
                         {io.x[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value smoothness_loss(Value masks) { return masks.graph().apply1(std::make_shared<SmoothnessLoss>(), {masks}); }

}  // namespace vkopple
