#include "graph/ops/blend.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct BlendPush {
  uint32_t count;  ///< B·H·W
  uint32_t pixels;
  uint32_t channels;
  uint32_t want_share;
  uint32_t want_a;
  uint32_t want_b;
  uint32_t accumulate_share;
  uint32_t accumulate_a;
  uint32_t accumulate_b;
};

BlendPush push_of(const Operand& share, const Operand& a) {
  const Shape& shape = a.shape();
  return {.count = words(share), .pixels = u32(shape[2] * shape[3]), .channels = u32(shape[1])};
}

}  // namespace

std::vector<TensorSpec> Blend::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  require(row_floats(x[1], 4) && x[1] == x[2] && row_floats(x[0], x[1].shape.with(1, 1)),
          fmt::format("takes row-major (B, 1, H, W) and two (B, C, H, W), not {}, {}, {}", x[0].shape.text(),
                      x[1].shape.text(), x[2].shape.text()));
  return {x[1]};
}

Needs Blend::needs(std::span<const TensorSpec>, const Caps&) const { return {.outputs_for_backward = 0}; }

void Blend::record_forward(Recorder& recorder, const Forward& io) const {
  const BlendPush push = push_of(io.x[0], io.x[1]);
  recorder.dispatch_flat("blend.forward", push.count,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.y[0].slice}, push);
}

void Blend::record_backward(Recorder& recorder, const Backward& io) const {
  BlendPush push = push_of(io.x[0], io.x[1]);
  push.want_share = io.wants(0) ? 1 : 0;
  push.want_a = io.wants(1) ? 1 : 0;
  push.want_b = io.wants(2) ? 1 : 0;
  push.accumulate_share = io.accumulates(0);
  push.accumulate_a = io.accumulates(1);
  push.accumulate_b = io.accumulates(2);
  recorder.dispatch_flat("blend.backward", push.count,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.dy[0].slice, io.dx[0].slice,
                          io.dx[1].slice, io.dx[2].slice},
                         push);
}

Value blend(Value share, Value a, Value b) {
  return share.graph().apply1(std::make_shared<Blend>(), {share, a, b});
}

}  // namespace vkopple
