#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "graph/conv/winograd.h"

namespace vkopple {

/// The tiles of a tensor's images, numbered through rows and images, and how they are cut: blocks of `width`
/// tiles that one workgroup takes through a frequency, and chunks of blocks whose transformed values stay in
/// the CPU's cache from one kernel to the next.
struct WinogradChunks {
  int64_t made;  ///< rows and columns of outputs that a tile makes
  int64_t images, rows, columns;
  int64_t width;
  int64_t chunk_blocks;

  int64_t tiles() const { return images * rows * columns; }
  int64_t blocks() const { return (tiles() + width - 1) / width; }
  int64_t frequencies() const { return (made + 2) * (made + 2); }
  /// Bytes of one chunk's transformed values.
  uint64_t bytes(int64_t channels4) const {
    return static_cast<uint64_t>(chunk_blocks * width * frequencies() * channels4) * 16;
  }
};

/// Tiles of images whose outputs are h by w; no chunk's transformed values of both operands, channels4 vectors
/// of channels together, exceed the cache's share, nor its tiles `most_tiles`, unless one block does.
WinogradChunks winograd_chunks(WinogradTile tile, int64_t images, int64_t h, int64_t w, int64_t width,
                               int64_t channels4, int64_t most_tiles = std::numeric_limits<int64_t>::max());

/// An NC4HW4 tensor that a transform reads or writes tile by tile.
struct TiledTensor {
  int64_t channels, h, w;
  int64_t offset = 0;  ///< from a tile's first output to the first row and column of the tensor that it needs
};

/// What winograd_tiles.glsl has for push constants.
struct WinogradPush {
  int32_t images, channels4, h, w, rows, columns;
  int32_t first_image, first_row, first_column;
  int32_t width, offset, channels, has_bias;
};

/// Records a transform ("winograd_input", "winograd_gradient" or "winograd_output") of the blocks from
/// `first_block` on, `blocks` of them.
void record_winograd_transform(Recorder& recorder, const char* shader, const WinogradChunks& chunks,
                               int64_t first_block, int64_t blocks, const TiledTensor& tensor,
                               std::initializer_list<Slice> bindings, bool has_bias = false,
                               const std::vector<uint32_t>& constants = {});

}  // namespace vkopple
