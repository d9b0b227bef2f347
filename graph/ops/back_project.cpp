#include "graph/ops/back_project.h"

#include <fmt/format.h>

#include "graph/kernels/camera.h"
#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct BackProjectPush {
  uint32_t count;  ///< B·H·W
  uint32_t pixels;
  uint32_t width;
  float centre_x;
  float centre_y;
  float inverse_focal;
  uint32_t accumulate;
};

BackProjectPush push_of(const Operand& depth, float fov, uint32_t accumulate) {
  const Shape& shape = depth.shape();
  return {.count = words(depth),
          .pixels = u32(shape[2] * shape[3]),
          .width = u32(shape[3]),
          .centre_x = centre(shape[3]),
          .centre_y = centre(shape[2]),
          .inverse_focal = static_cast<float>(1 / focal_length(shape[2], fov)),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> BackProject::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  require(row_floats(x[0], 4) && x[0].shape[1] == 1,
          fmt::format("takes row-major depth (B, 1, H, W), not {}", x[0].shape.text()));
  require(is_fov(fov_), fmt::format("the field of view {} is not between 0 and pi", fov_));
  return {row_major(x[0].shape.with(1, 3))};
}

Needs BackProject::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void BackProject::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_of(io.x[0], fov_, 0);
  recorder.dispatch_flat("back_project.forward", (push.count + 3) / 4, {io.x[0].slice, io.y[0].slice}, push);
}

void BackProject::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_of(io.dx[0], fov_, io.accumulates(0));
  recorder.dispatch_flat("back_project.backward", (push.count + 3) / 4, {io.dy[0].slice, io.dx[0].slice}, push);
}

Value back_project(Value depth, float fov) {
  return depth.graph().apply1(std::make_shared<BackProject>(fov), {depth});
}

}  // namespace vkopple
