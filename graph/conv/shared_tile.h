#pragma once

#include <cstdint>
#include <span>

#include "runtime/caps.h"

namespace vkopple {

/// How workgroups of conv_shared.comp cut a product into tiles of output channels × pixels. Powers of 2.
struct SharedTile {
  uint32_t out4;    ///< vectors of 4 output channels of an invocation
  uint32_t pixels;  ///< of an invocation
  uint32_t across;  ///< invocations across pixels
  uint32_t down;    ///< invocations across output channels
  uint32_t depth;   ///< vectors of 4 input channels that lie in shared memory at a time

  uint32_t invocations() const { return across * down; }
  uint32_t tile_pixels() const { return across * pixels; }
  uint32_t tile_channels() const { return 4 * down * out4; }
  /// Both halves of the double buffer.
  uint32_t shared_bytes() const { return 2 * depth * (tile_pixels() + tile_channels()) * 16; }
  bool operator==(const SharedTile&) const = default;
};

/// Whether the kernel is right for the tile, whatever the device: powers of 2, sums that fit into registers.
bool is_shared_tile(const SharedTile& tile);
/// Whether the device has the invocations and the shared memory.
bool fits(const SharedTile& tile, const Caps& caps);
/// Tiles worth a try, for the tuner; not all fit every device.
std::span<const SharedTile> shared_tiles();

/// What a tile is chosen by.
struct SharedWork {
  int64_t pixels;  ///< of one phase, of all images
  int64_t phases;  ///< products of that many pixels; 4 for a transposed convolution of stride 2
  int64_t out4;    ///< vectors of 4 output channels
  int64_t in4;     ///< and of input channels
};

/// The tile estimated to be fastest among those that fit. Any device of Vulkan's minimum limits has one.
SharedTile choose_shared_tile(const SharedWork& work, const Caps& caps);

/// Tiles of the weight gradient in weight_gradient_shared.comp: output channels × (taps × input channels).
/// Powers of 2.
struct SharedGradientTile {
  uint32_t rows4;     ///< vectors of 4 output channels of an invocation
  uint32_t columns4;  ///< vectors of 4 input channels of one tap, of an invocation
  uint32_t across;    ///< invocations across columns
  uint32_t down;      ///< invocations across rows
  uint32_t depth;     ///< pixels that lie in shared memory at a time

  uint32_t invocations() const { return across * down; }
  uint32_t tile_rows4() const { return down * rows4; }
  uint32_t tile_columns4() const { return across * columns4; }
  /// Both halves of the double buffer, with a vector more for each pixel and operand against bank conflicts.
  uint32_t shared_bytes() const { return 2 * depth * (tile_rows4() + tile_columns4() + 2) * 16; }
  bool operator==(const SharedGradientTile&) const = default;
};

bool is_shared_tile(const SharedGradientTile& tile);
bool fits(const SharedGradientTile& tile, const Caps& caps);
std::span<const SharedGradientTile> shared_gradient_tiles();

struct SharedGradientWork {
  int64_t pixels;    ///< that are summed
  int64_t rows4;     ///< vectors of 4 output channels
  int64_t columns4;  ///< taps times vectors of 4 input channels
};

SharedGradientTile choose_shared_gradient_tile(const SharedGradientWork& work, const Caps& caps);

}  // namespace vkopple
