#pragma once

#include <cstdint>
#include <span>

#include "runtime/caps.h"

namespace vkopple {

/// How workgroups of linear_shared.comp cut a product of matrices into tiles of rows × columns. Powers of 2.
struct LinearTile {
  uint32_t rows4;     ///< vectors of 4 rows of an invocation
  uint32_t columns4;  ///< vectors of 4 columns of an invocation
  uint32_t across;    ///< invocations across columns
  uint32_t down;      ///< invocations across rows
  uint32_t depth;     ///< terms that lie in shared memory at a time

  uint32_t invocations() const { return across * down; }
  uint32_t rows() const { return 4 * down * rows4; }
  uint32_t columns() const { return 4 * across * columns4; }
  /// Both halves of the double buffer, with a vector more for each term and operand against bank conflicts.
  uint32_t shared_bytes() const { return 2 * depth * (down * rows4 + across * columns4 + 2) * 16; }
  bool operator==(const LinearTile&) const = default;
};

/// Whether the device has the invocations and the shared memory.
bool fits(const LinearTile& tile, const Caps& caps);
/// All there are; not all fit every device.
std::span<const LinearTile> linear_tiles();
/// The tile estimated to be fastest for a product of so many rows and columns among those that fit. Any device
/// of Vulkan's minimum limits has one.
LinearTile choose_linear_tile(int64_t rows, int64_t columns, const Caps& caps);

}  // namespace vkopple
