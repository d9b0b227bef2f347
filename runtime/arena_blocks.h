#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vkopple {

struct Caps;

/// How an arena cuts what it hands out from a few large blocks, front to back. Plain numbers: what an arena
/// will take is known before it takes anything.
class ArenaBlocks {
 public:
  /// block_bytes: size of one block, as far as the device allows; a larger request gets a block of its own.
  ArenaBlocks(const Caps& caps, uint64_t block_bytes);

  void add(uint64_t bytes);
  uint64_t total_bytes() const { return total_bytes_; }

  /// Where a request lies, of an arena whose last block has `block` bytes (0: there is none), `used` of them.
  struct Place {
    uint64_t new_block = 0;  ///< bytes of the block that it needs; 0: the last one holds it
    uint64_t offset = 0;     ///< into its block
    uint64_t used = 0;       ///< of its block from then on
  };
  static Place place(const Caps& caps, uint64_t block_bytes, uint64_t block, uint64_t used, uint64_t bytes);

 private:
  const Caps* caps_;
  uint64_t block_bytes_;
  uint64_t block_ = 0;
  uint64_t used_ = 0;
  uint64_t total_bytes_ = 0;
};

}  // namespace vkopple
