#pragma once

#include <cstdint>
#include <span>

#include "runtime/caps.h"

namespace vkopple {

/// What one invocation of conv_product makes.
struct ConvTile {
  int64_t out4;  ///< vectors of 4 output channels: 1 (only where there are no more than 4 channels), 2, 4 or 8
  int64_t pixels;  ///< 1, 2, 4 or 8
};

constexpr int64_t kMostTileChannels = 32;

/// Tiles worth a try.
std::span<const ConvTile> conv_tiles();

/// What a tile is chosen by.
struct ConvWork {
  int64_t pixels;  ///< that are made, of all images
  int64_t out_channels;
  int64_t in4;    ///< vectors of 4 input channels
  double taps;    ///< that a pixel reads, on average
  int64_t lanes;  ///< invocations of a workgroup
};

/// For register tiles with weights handed round a subgroup, on a CPU of `threads`.
ConvTile choose_shuffle_tile(const ConvWork& work, int64_t threads);
/// For kernels that load weights from the same address in all invocations.
ConvTile choose_uniform_tile(const ConvWork& work);

/// Whether a direct kernel should store rows (shaders/include/row_store.glsl): their code is long, a dozen
/// instructions for each of a subgroup's vectors, which the driver compiles and a processor fetches. It pays
/// where a sum is short, or Caps::long_work. `iterations`: products of vectors of 4 channels that make a sum;
/// `vectors`: of 4 channels that an invocation makes.
bool row_stores_pay(int64_t iterations, int64_t vectors, const Caps& caps);

}  // namespace vkopple
