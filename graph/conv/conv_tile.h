#pragma once

#include <cstdint>

namespace vkopple {

/// What one invocation of conv_product makes.
struct ConvTile {
  int out4;    ///< vectors of 4 output channels: 1 (where there are no more than 4 channels), 2, 4 or 8
  int pixels;  ///< 1, 2, 4 or 8
};

constexpr int64_t kMostTileChannels = 32;

/// For register tiles with weights handed round a subgroup of `lanes`, `pixels` counting all that are made.
ConvTile choose_shuffle_tile(int64_t pixels, int64_t out_channels, int64_t lanes);
/// For kernels that load weights from the same address in all invocations.
ConvTile choose_uniform_tile(int64_t pixels, int64_t out_channels, int64_t lanes);

}  // namespace vkopple
