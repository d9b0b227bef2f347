#include "graph/ops/pose_contrast.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/checks/check_poses.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x, PoseDivergence divergence) {
  const Shape& shape = x[0].shape;
  HostTensor y({1});
  for (int64_t b = 0; b < shape[0]; ++b)
    for (int64_t k = 0; k < shape[1]; ++k) {
      double distance = 0;
      for (int64_t n = 0; n < shape[2]; ++n)
        distance +=
            bin_divergence(x[1].at(b, k, n), x[0].at(static_cast<int64_t>(x[3].at(b)), k, n), divergence);
      y.values[0] -= x[2].at(b, k) * std::min(distance, 2.0) / static_cast<double>(shape[0]);
    }
  return {y};
}

void prepare(HostTensors& x) {
  normalise_poses(x[0]);
  normalise_poses(x[1]);
  const int64_t batch = x[3].shape[0];
  for (int64_t b = 0; b < batch; ++b) x[3].at(b) = static_cast<double>((b * 3 + 2) % batch);
}

}  // namespace

// Logarithms up to ±4 make Kullback-Leibler divergences on both sides of the cap, up to ±1 below it alone.
void check_pose_contrast(CheckList& list) {
  for (const PoseDivergence divergence : {PoseDivergence::kKl, PoseDivergence::kJs})
    for (const double range : {1.0, 4.0})
      for (const Shape& shape : {Shape{1, 1, 2}, Shape{2, 3, 120}, Shape{7, 2, 33}})
        list.push_back({.label = fmt::format("{} {}, logarithms up to {}", shape.text(),
                                             divergence == PoseDivergence::kKl ? "KL" : "JS", range),
                        .op = std::make_shared<PoseContrast>(divergence),
                        .inputs = {row_major(shape), row_major(shape), row_major({shape[0], shape[1]}),
                                   unsigned_ints({shape[0]})},
                        .reference = [divergence](const HostTensors& x) { return reference(x, divergence); },
                        .ranges = {{-range, range}, {-range, range}, {0, 1}, {0, 1}},
                        .prepare = prepare});
}

}  // namespace vkopple
