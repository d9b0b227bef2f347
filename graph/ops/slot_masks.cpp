#include "graph/ops/slot_masks.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct SlotMasksPush {
  uint32_t count;  ///< B·H·W
  uint32_t pixels;
  uint32_t slots;
  uint32_t accumulate;
};

SlotMasksPush push_of(const Shape& masks, uint32_t accumulate) {
  return {.count = u32(masks[0] * masks[2] * masks[3]),
          .pixels = u32(masks[2] * masks[3]),
          .slots = u32(masks[1] - 1),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> SlotMasks::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  require(row_floats(x[0], 4), fmt::format("takes row-major logits (K, B, H, W), not {}", x[0].shape.text()));
  const Shape& s = x[0].shape;
  return {row_major({s[1], s[0] + 1, s[2], s[3]})};
}

Needs SlotMasks::needs(std::span<const TensorSpec>, const Caps&) const { return {.inputs_for_backward = 0}; }

void SlotMasks::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_of(io.y[0].shape(), 0);
  recorder.dispatch_flat("slot_masks.forward", push.count, {io.x[0].slice, io.y[0].slice}, push);
}

void SlotMasks::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_of(io.y[0].shape(), io.accumulates(0));
  recorder.dispatch_flat("slot_masks.backward", push.count, {io.y[0].slice, io.dy[0].slice, io.dx[0].slice},
                         push);
}

Value slot_masks(Value logits) { return logits.graph().apply1(std::make_shared<SlotMasks>(), {logits}); }

}  // namespace vkopple
