#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/autodiff.h"
#include "graph/graph.h"
#include "graph/memory_use.h"
#include "graph/plan.h"
#include "graph/recompute.h"

namespace vkopple {

struct Caps;

/// Where everything lies that a graph does not keep: in stretches of memory that are shared by lifetime. Time
/// counts forward nodes first, then backward steps, each of which may have nodes run again before it. Needs no
/// device.
struct MemoryLayout {
  /// A stretch by its number, or none.
  using Stretch = int64_t;
  static constexpr Stretch kNone = -1;

  struct NodeStretches {
    std::vector<Stretch> saved;
    Stretch forward_scratch = kNone;
    Stretch backward_scratch = kNone;
  };

  std::vector<MemoryUse> stretches;
  MemoryPlan plan;  ///< where each of them lies
  // By root value; none for what lies in groups or is kept.
  std::vector<Stretch> data;
  std::vector<Stretch> again;  ///< where backward computes it again
  std::vector<Stretch> gradients;
  std::vector<NodeStretches> nodes;
};

/// Whether a root value has memory of its own as long as the graph lives: groups, inputs, what is kept.
bool has_own_memory(const ValueInfo& root);
/// Whether that is a group's.
bool in_group(const ValueInfo& root);

/// `in_place`: outputs take over the bytes of inputs where ops allow it. `loss` may be none.
MemoryLayout lay_out(const Graph& graph, Value loss, const BackwardPlan& backward,
                     const Recomputation& recomputation, std::span<const Needs> needs, const Caps& caps,
                     bool in_place);

}  // namespace vkopple
