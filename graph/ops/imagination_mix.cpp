#include "graph/ops/imagination_mix.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ImaginationMixPush {
  uint32_t count;  ///< B·H·W
  uint32_t pixels;
  uint32_t slots;
  float max_depth;
  uint32_t accumulate;
};

ImaginationMixPush push_of(const Operand& y, int64_t slots, float max_depth, uint32_t accumulate) {
  const Shape& s = y.shape();
  return {.count = u32(s[0] / slots * s[2] * s[3]),
          .pixels = u32(s[2] * s[3]),
          .slots = u32(slots),
          .max_depth = max_depth,
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> ImaginationMix::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  const Shape& s = x[0].shape;
  require(slots_ >= 1, "takes at least one slot");
  require(x[0].layout == Layout::kChannels4 && s.rank() == 4 && s[1] == 5 && s[0] % slots_ == 0,
          fmt::format("takes NC4HW4 (B * {}, 5, H, W), not {}", slots_, s.text()));
  const int64_t images = s[0] / slots_;
  return {row_major({images, 3, s[2], s[3]}), row_major({images, 1, s[2], s[3]})};
}

Needs ImaginationMix::needs(std::span<const TensorSpec>, const Caps&) const { return {}; }

void ImaginationMix::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_of(io.x[0], slots_, max_depth_, 0);
  recorder.dispatch_flat("imagination_mix.forward", push.count, {io.x[0].slice, io.y[0].slice, io.y[1].slice},
                         push);
}

void ImaginationMix::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_of(io.x[0], slots_, max_depth_, io.accumulates(0));
  recorder.dispatch_flat(
      "imagination_mix.backward", push.count,
      {io.x[0].slice, io.y[0].slice, io.y[1].slice, io.dy[0].slice, io.dy[1].slice, io.dx[0].slice}, push);
}

std::vector<Value> imagination_mix(Value y, int64_t slots, float max_depth) {
  return y.graph().apply(std::make_shared<ImaginationMix>(slots, max_depth), {y});
}

}  // namespace vkopple
