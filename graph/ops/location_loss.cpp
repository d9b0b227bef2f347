#include "graph/ops/location_loss.h"

#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct LocationLossPush {
  uint32_t objects;
  uint32_t numbers;  ///< D
  float scale;       ///< 1 / B
  uint32_t wants;
  uint32_t accumulates;  ///< bit i of both speaks of input i
};

LocationLossPush push_for(const Shape& x) {
  return {.objects = u32(x[0] * x[1]), .numbers = u32(x[2]), .scale = 1.0F / static_cast<float>(x[0])};
}

}  // namespace

std::vector<TensorSpec> LocationLoss::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  for (const TensorSpec& spec : x)
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32, "takes row-major floats");
  const Shape& a = x[0].shape;
  require(a.rank() == 3 && x[1].shape == a && x[2].shape == Shape{a[0], a[1]},
          "takes (B, K, D) twice and (B, K), not " + a.text() + ", " + x[1].shape.text() + " and " +
              x[2].shape.text());
  return {row_major({1})};
}

Needs LocationLoss::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.forward_scratch = TermSum(words(x[2])).scratch_bytes(), .outputs_for_backward = 0};
}

void LocationLoss::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].shape());
  const TermSum sum(push.objects);
  recorder.dispatch_flat("location_loss.forward", push.objects,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, sum.terms(io.scratch)}, push);
  sum.record(recorder, io.scratch, io.y[0].slice, push.scale);
}

void LocationLoss::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[0].shape());
  push.wants = io.wants_mask();
  push.accumulates = io.accumulates_mask();
  recorder.dispatch_flat("location_loss.backward", push.objects,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.dy[0].slice, io.dx[0].slice,
                          io.dx[1].slice, io.dx[2].slice},
                         push);
}

Value location_loss(Value aligned, Value seen, Value q) {
  return aligned.graph().apply1(std::make_shared<LocationLoss>(), {aligned, seen, q});
}

}  // namespace vkopple
