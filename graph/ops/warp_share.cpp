#include "graph/ops/warp_share.h"

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct WarpSharePush {
  uint32_t words;
  uint32_t accumulate;
};

}  // namespace

std::vector<TensorSpec> WarpShare::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  require(x[0] == row_major(x[0].shape), "takes row-major floats");
  return {x[0]};
}

Needs WarpShare::needs(std::span<const TensorSpec>, const Caps&) const { return {.outputs_for_backward = 0}; }

void WarpShare::record_forward(Recorder& recorder, const Forward& io) const {
  if (!warp_) return recorder.fill(io.y[0].slice);
  const WarpSharePush push{words(io.x[0]), 0};
  recorder.dispatch_flat("warp_share.forward", (push.words + 3) / 4, {io.x[0].slice, io.y[0].slice}, push);
}

void WarpShare::record_backward(Recorder& recorder, const Backward& io) const {
  const WarpSharePush push{words(io.x[0]), io.accumulates(0)};
  recorder.dispatch_flat("warp_share.backward", (push.words + 3) / 4,
                         {io.x[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value warp_share(Value total, bool warp) {
  return total.graph().apply1(std::make_shared<WarpShare>(warp), {total});
}

}  // namespace vkopple
