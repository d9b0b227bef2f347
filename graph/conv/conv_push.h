#pragma once

#include <cstdint>

#include "graph/conv/conv_product.h"

namespace vkopple {

/// Push constants of a convolution's products, as conv_product.comp and conv_shared.comp explain them.
struct ProductPush {
  int32_t n, in4, out4, h, w, out_h, out_w;
  int32_t kernel, stride, step, tap_step, phases;
  int32_t first[2], taps[2], base[2];
  int32_t tiles, bias;
};

/// Channels that a product reads and makes.
struct Channels {
  int64_t in, out;
};
Channels channels_of(const ConvShape& shape, ConvDirection direction);

/// Pixels of all images that the largest phase makes; phases differ by a row and a column at most.
int64_t phase_pixels(const ProductPush& push);

/// Workgroups for so many tiles of every phase in the first two directions (a few more where they need both,
/// which have nothing to do), phases in the third.
Groups phase_groups(int64_t tiles, int64_t phases, const Caps& caps);

}  // namespace vkopple
