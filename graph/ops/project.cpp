#include "graph/ops/project.h"

#include <fmt/format.h>

#include "graph/kernels/camera.h"
#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ProjectPush {
  uint32_t count;  ///< B·S·H·W
  uint32_t pixels;
  float focal;
  uint32_t accumulate;
};

ProjectPush push_of(const Operand& points, float fov, uint32_t accumulate) {
  const Shape& shape = points.shape();
  return {.count = words(points) / 3,
          .pixels = u32(shape[3] * shape[4]),
          .focal = static_cast<float>(focal_length(shape[3], fov)),
          .accumulate = accumulate};
}

}  // namespace

std::vector<TensorSpec> Project::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  require(row_floats(x[0], 5) && x[0].shape[2] == 3,
          fmt::format("takes row-major points (B, S, 3, H, W), not {}", x[0].shape.text()));
  require(is_fov(fov_), fmt::format("the field of view {} is not between 0 and pi", fov_));
  return {x[0]};
}

Needs Project::needs(std::span<const TensorSpec>, const Caps&) const { return {.outputs_for_backward = 0}; }

void Project::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_of(io.x[0], fov_, 0);
  recorder.dispatch_flat("project.forward", (push.count + 3) / 4, {io.x[0].slice, io.y[0].slice}, push);
}

void Project::record_backward(Recorder& recorder, const Backward& io) const {
  const auto push = push_of(io.x[0], fov_, io.accumulates(0));
  recorder.dispatch_flat("project.backward", (push.count + 3) / 4,
                         {io.x[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value project(Value points, float fov) {
  return points.graph().apply1(std::make_shared<Project>(fov), {points});
}

}  // namespace vkopple
