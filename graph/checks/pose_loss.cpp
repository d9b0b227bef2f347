#include "graph/ops/pose_loss.h"

#include <fmt/format.h>

#include "graph/checks/check_poses.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x, PoseDivergence divergence) {
  const Shape& shape = x[0].shape;
  HostTensor y({1});
  for (int64_t b = 0; b < shape[0]; ++b)
    for (int64_t k = 0; k < shape[1]; ++k)
      for (int64_t n = 0; n < shape[2]; ++n)
        y.values[0] += x[2].at(b, k) * bin_divergence(x[0].at(b, k, n), x[1].at(b, k, n), divergence) /
                       static_cast<double>(shape[0]);
  return {y};
}

}  // namespace

void check_pose_loss(CheckList& list) {
  for (PoseDivergence divergence : {PoseDivergence::kKl, PoseDivergence::kJs})
    for (const Shape& shape : {Shape{1, 1, 2}, Shape{2, 3, 120}, Shape{3, 1, 7}, Shape{5, 2, 33}})
      list.push_back(
          {.label = fmt::format("{} {}", shape.text(), divergence == PoseDivergence::kKl ? "KL" : "JS"),
           .op = std::make_shared<PoseLoss>(divergence),
           .inputs = {row_major(shape), row_major(shape), row_major({shape[0], shape[1]})},
           .reference = [divergence](const HostTensors& x) { return reference(x, divergence); },
           .ranges = {{-4, 4}, {-4, 4}, {0, 1}},
           .prepare =
               [](HostTensors& x) {
                 normalise_poses(x[0]);
                 normalise_poses(x[1]);
               }});
}

}  // namespace vkopple
