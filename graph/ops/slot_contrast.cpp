#include "graph/ops/slot_contrast.h"

#include "graph/kernels/expect.h"
#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct SlotContrastPush {
  uint32_t count;  ///< B K
  uint32_t slots;
  float scale;  ///< -1 / B
  uint32_t accumulate;
};

SlotContrastPush push_for(const Shape& location, uint32_t accumulate) {
  return {.count = u32(location[0] * location[1]),
          .slots = u32(location[1]),
          .scale = -1.0F / static_cast<float>(location[0]),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> SlotContrast::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && row_floats(x[0], 3) && x[0].shape[2] == 3, "takes row-major locations (B, K, 3)");
  return {row_major({1})};
}

Needs SlotContrast::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.forward_scratch = TermSum(push_for(x[0].shape, 0).count).scratch_bytes(), .outputs_for_backward = 0};
}

void SlotContrast::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].shape(), 0);
  const TermSum sum(push.count);
  recorder.dispatch_flat("slot_contrast.forward", push.count, {io.x[0].slice, sum.terms(io.scratch)}, push);
  sum.record(recorder, io.scratch, io.y[0].slice, push.scale);
}

void SlotContrast::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_for(io.x[0].shape(), io.accumulates(0));
  recorder.dispatch_flat("slot_contrast.backward", push.count, {io.x[0].slice, io.dy[0].slice, io.dx[0].slice},
                         push);
}

Value slot_contrast(Value location) {
  return location.graph().apply1(std::make_shared<SlotContrast>(), {location});
}

}  // namespace vkopple
