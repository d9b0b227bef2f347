#include "graph/ops/collapse_loss.h"

#include <algorithm>
#include <cmath>

#include "graph/checks/check.h"

namespace vkopple {
namespace {

HostTensors reference(const HostTensors& x) {
  const Shape& q = x[2].shape;
  HostTensor y({1});
  for (int64_t b = 0; b < q[0]; ++b)
    for (int64_t k = 0; k < q[1]; ++k) {
      double norm = 0;
      for (int64_t d = 0; d < 3; ++d)
        norm += std::abs(x[0].at(static_cast<int64_t>(x[3].at(b)), k, d) - x[1].at(b, k, d));
      y.values[0] -= x[2].at(b, k) * std::min(norm, 1.0) / static_cast<double>(q[0]);
    }
  return {y};
}

/// A permutation that moves everything, by a step that shares no factor with the batch.
void permute(HostTensors& x) {
  const int64_t batch = x[3].shape[0];
  for (int64_t b = 0; b < batch; ++b) x[3].at(b) = static_cast<double>((b * 3 + 2) % batch);
}

}  // namespace

void check_collapse_loss(CheckList& list) {
  for (const Shape& q : {Shape{1, 1}, Shape{2, 3}, Shape{20, 3}, Shape{131, 5}})
    list.push_back({.label = q.text(),
                    .op = std::make_shared<CollapseLoss>(),
                    .inputs = {row_major({q[0], q[1], 3}), row_major({q[0], q[1], 3}), row_major(q),
                               unsigned_ints({q[0]})},
                    .reference = reference,
                    .ranges = {{-0.5, 0.5}, {-0.5, 0.5}, {0, 1}, {0, 1}},
                    .prepare = permute});
}

}  // namespace vkopple
