#include "runtime/arena_blocks.h"

#include <algorithm>

#include "runtime/caps.h"

namespace vkopple {

ArenaBlocks::ArenaBlocks(const Caps& caps, uint64_t block_bytes) : caps_(&caps), block_bytes_(block_bytes) {}

ArenaBlocks::Place ArenaBlocks::place(const Caps& caps, uint64_t block_bytes, uint64_t block, uint64_t used,
                                      uint64_t bytes) {
  const uint64_t align = caps.offset_alignment;
  const uint64_t rounded = (std::max<uint64_t>(bytes, 16) + align - 1) / align * align;
  if (used + rounded <= block) return {.offset = used, .used = used + rounded};
  return {.new_block = std::max(std::min(block_bytes, caps.max_allocation_bytes), rounded), .used = rounded};
}

void ArenaBlocks::add(uint64_t bytes) {
  const Place next = place(*caps_, block_bytes_, block_, used_, bytes);
  if (next.new_block > 0) block_ = next.new_block;
  total_bytes_ += next.new_block;
  used_ = next.used;
}

}  // namespace vkopple
