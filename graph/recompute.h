#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/autodiff.h"
#include "graph/graph.h"

namespace vkopple {

/// Which values backward computes again instead of keeping them from forward. A recomputed value has two lives:
/// in forward up to its last reader there, and in backward from the step `first` on.
struct Recomputation {
  std::vector<std::vector<size_t>> before;  ///< by backward step: nodes that run again before it, in order
  std::vector<int64_t> first;               ///< by root: the backward step before which it is made again, or -1
  bool again(int root) const { return first[static_cast<size_t>(root)] >= 0; }
};

/// Chooses every value of at least `least_bytes` whose op is cheap to run again (Op::recomputes) and finds its
/// inputs where backward first reads the value: kept for a step that is not over by then, or recomputed too. An
/// input that has readers of its own is not made early for it unless it is the smaller of both.
Recomputation plan_recomputation(const Graph& graph, const BackwardPlan& backward, std::span<const Needs> needs,
                                 uint64_t least_bytes);

}  // namespace vkopple
