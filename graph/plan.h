#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vkopple {

/// Memory wanted from step `first` to step `last`, both included.
struct MemoryRequest {
  uint64_t bytes = 0;
  int64_t first = 0;
  int64_t last = 0;
};

struct Placement {
  size_t block = 0;
  uint64_t offset = 0;
};

struct MemoryPlan {
  std::vector<Placement> placements;  ///< by request
  std::vector<uint64_t> block_bytes;
  uint64_t total_bytes() const;
};

/// Places requests in as few bytes as a greedy choice finds: largest first, each at the lowest offset that is
/// free during its life, in blocks of at most block_limit bytes (a larger request gets a block of its own
/// size).
MemoryPlan plan_memory(std::span<const MemoryRequest> requests, uint64_t block_limit, uint64_t alignment);

}  // namespace vkopple
