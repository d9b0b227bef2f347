#include "graph/ops/imagination_input.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ImaginationInputPush {
  uint32_t count;  ///< B·H·W
  uint32_t pixels;
  uint32_t slots;  ///< S
  uint32_t want_depth;
  uint32_t want_masks;
  uint32_t accumulate_depth;
  uint32_t accumulate_masks;
};

ImaginationInputPush push_of(const Operand& masks) {
  const Shape& s = masks.shape();
  return {.count = u32(s[0] * s[2] * s[3]), .pixels = u32(s[2] * s[3]), .slots = u32(s[1])};
}

}  // namespace

std::vector<TensorSpec> ImaginationInput::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  const Shape& s = x[2].shape;
  require(row_floats(x[2], 4) && row_floats(x[0], s.with(1, 3)) && row_floats(x[1], s.with(1, 1)),
          fmt::format(
              "takes row-major image (B, 3, H, W), depth (B, 1, H, W) and masks (B, S, H, W), not {}, {}, {}",
              x[0].shape.text(), x[1].shape.text(), s.text()));
  return {channels4({s[0] * s[1], 4, s[2], s[3]})};
}

Needs ImaginationInput::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.outputs_for_backward = 0};
}

void ImaginationInput::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_of(io.x[2]);
  recorder.dispatch_flat("imagination_input.forward", push.count,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.y[0].slice}, push);
}

void ImaginationInput::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_of(io.x[2]);
  push.want_depth = io.wants(1) ? 1 : 0;
  push.want_masks = io.wants(2) ? 1 : 0;
  push.accumulate_depth = io.accumulates(1);
  push.accumulate_masks = io.accumulates(2);
  recorder.dispatch_flat(
      "imagination_input.backward", push.count,
      {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.dy[0].slice, io.dx[1].slice, io.dx[2].slice}, push);
}

Value imagination_input(Value image, Value depth, Value masks) {
  return image.graph().apply1(std::make_shared<ImaginationInput>(), {image, depth, masks});
}

}  // namespace vkopple
