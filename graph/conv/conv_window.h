#pragma once

#include <cstdint>

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_shape.h"
#include "runtime/recorder.h"

namespace vkopple {

/// What one invocation of conv_window makes.
struct ConvWindowTile {
  int64_t channels;  ///< 8, 16 or 32, or all where there are no more than 8
  int64_t pixels;    ///< in a row, of each phase of columns (2 in a transposed product of stride 2, else 1)
};

/// Whether the device can run conv_window on a product: kernels up to 3x3 without dilation, no exact sums.
bool can_conv_window(const Caps& caps);
bool can_conv_window(const ConvShape& shape, const Caps& caps);
/// … and whether it is faster than conv_product.
bool prefers_conv_window(const ConvShape& shape, ConvDirection direction, const Caps& caps);

/// Estimated nanoseconds of the product with a tile, on one thread of a CPU.
double conv_window_cost(const ConvShape& shape, ConvDirection direction, const ConvWindowTile& tile,
                        const Caps& caps);

/// The cheapest tile.
ConvWindowTile choose_window_tile(const ConvShape& shape, ConvDirection direction, const Caps& caps);

/// Records the product; `packed` holds the weights as conv_pack.comp leaves them, and the bias from vector
/// `bias_at` on.
void record_conv_window(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                        const ConvOperands& operands, const Slice& packed, int64_t bias_at,
                        const ConvWindowTile& tile);

}  // namespace vkopple
