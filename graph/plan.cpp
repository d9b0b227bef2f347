#include "graph/plan.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace vkopple {
namespace {

struct Placed {
  uint64_t begin;
  uint64_t end;
  int64_t first;
  int64_t last;
};

/// The lowest offset where `bytes` are free throughout the request's life, given what the block holds.
uint64_t lowest_offset(const std::vector<Placed>& block, const MemoryRequest& request, uint64_t bytes) {
  uint64_t offset = 0;
  for (const Placed& other : block) {  // in order of their offsets
    if (other.last < request.first || request.last < other.first) continue;
    if (offset + bytes <= other.begin) break;
    offset = std::max(offset, other.end);
  }
  return offset;
}

}  // namespace

uint64_t MemoryPlan::total_bytes() const {
  return std::accumulate(block_bytes.begin(), block_bytes.end(), uint64_t{0});
}

MemoryPlan plan_memory(std::span<const MemoryRequest> requests, uint64_t block_limit, uint64_t alignment) {
  std::vector<size_t> order(requests.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return requests[a].bytes > requests[b].bytes; });
  MemoryPlan plan;
  plan.placements.resize(requests.size());
  std::vector<std::vector<Placed>> blocks;
  for (size_t index : order) {
    const MemoryRequest& request = requests[index];
    const uint64_t bytes = (std::max<uint64_t>(request.bytes, 1) + alignment - 1) / alignment * alignment;
    size_t b = 0;
    uint64_t offset = 0;
    for (; b < blocks.size(); ++b) {
      offset = lowest_offset(blocks[b], request, bytes);
      if (offset + bytes <= std::max(block_limit, plan.block_bytes[b])) break;
    }
    if (b == blocks.size()) {
      blocks.emplace_back();
      plan.block_bytes.push_back(0);
      offset = 0;
    }
    const Placed placed{offset, offset + bytes, request.first, request.last};
    auto& block = blocks[b];
    block.insert(std::upper_bound(block.begin(), block.end(), placed,
                                  [](const Placed& x, const Placed& y) { return x.begin < y.begin; }),
                 placed);
    plan.placements[index] = {b, offset};
    plan.block_bytes[b] = std::max(plan.block_bytes[b], placed.end);
  }
  return plan;
}

}  // namespace vkopple
