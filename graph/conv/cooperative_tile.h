#pragma once

#include <cstdint>

#include "runtime/caps.h"

namespace vkopple {

/// How workgroups of conv_cooperative.comp cut a product into tiles of pixels × output channels: matrices of a
/// subgroup, and subgroups. Powers of 2.
struct CooperativeTile {
  MatrixShape matrix;  ///< m pixels, n output channels, k input channels
  uint32_t rows;       ///< matrices of a subgroup across pixels
  uint32_t columns;    ///< and across output channels
  uint32_t down;       ///< subgroups across pixels
  uint32_t across;     ///< and across output channels
  uint32_t depth;      ///< matrices across input channels that lie in shared memory at a time

  uint32_t subgroups() const { return down * across; }
  uint32_t tile_pixels() const { return down * rows * matrix.m; }
  uint32_t tile_channels() const { return across * columns * matrix.n; }
  uint32_t slab_channels() const { return depth * matrix.k; }
  /// As the kernel declares it: both halves of the double buffer, a matrix of each subgroup on its way out, and
  /// where pixels lie.
  uint32_t shared_bytes() const;
  bool operator==(const CooperativeTile&) const = default;
};

/// Whether the device has the invocations, the shared memory and, by estimate, the registers.
bool fits(const CooperativeTile& tile, const Caps& caps);
/// Whether any tile does.
bool has_cooperative_tile(const Caps& caps);

/// What a tile is chosen by.
struct CooperativeWork {
  int64_t pixels;  ///< of one phase, of all images
  int64_t phases;
  int64_t out_channels;
  int64_t in_channels;
};

/// The tile estimated to be fastest among those that fit. Throws Error where none does.
CooperativeTile choose_cooperative_tile(const CooperativeWork& work, const Caps& caps);

}  // namespace vkopple
