#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "graph/autodiff.h"
#include "graph/executor_options.h"
#include "graph/memory_layout.h"
#include "graph/recompute.h"

namespace vkopple {

/// All that is decided before a graph gets memory. Needs no device.
struct ExecutionPlan {
  std::vector<Needs> needs;  ///< by node
  BackwardPlan backward;     ///< without steps in inference
  Recomputation recomputation;
  MemoryLayout layout;

  std::map<std::string, uint64_t> groups;  ///< bytes of what a GroupStore holds, by name
  uint64_t kept_bytes = 0;                 ///< of an executor's arena of inputs and what is kept
  uint64_t shared_bytes() const { return layout.plan.total_bytes(); }
  /// Bytes of device memory that an executor takes beside its groups.
  uint64_t own_bytes() const { return kept_bytes + shared_bytes(); }
};

/// For an executor with these options; the graph gets no further nodes. Throws Error as plan_backward does.
ExecutionPlan plan_execution(const Caps& caps, Graph& graph, const ExecutorOptions& options);

/// Bytes of one allocation of the arenas of an executor's inputs and outputs, and of a group store's.
inline constexpr uint64_t kKeptBlockBytes = uint64_t{4} << 20;
inline constexpr uint64_t kGroupBlockBytes = uint64_t{16} << 20;

/// Bytes of device memory that a new GroupStore takes for groups, got in order of their names.
uint64_t group_store_bytes(const Caps& caps, const std::map<std::string, uint64_t>& groups);

}  // namespace vkopple
