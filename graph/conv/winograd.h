#pragma once

#include <cstdint>

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_shape.h"
#include "runtime/recorder.h"

namespace vkopple {

/// Winograd's minimal filtering of 3 x 3 convolutions of stride 1 and dilation 1
/// (shaders/include/winograd.glsl): tiles of m x m outputs by (m + 2)² instead of 9 m² products for each pair
/// of channels. Its rounding error grows with m.
enum class WinogradTile : int64_t { k2 = 2, k4 = 4 };

/// Whether the device can run it on this shape, all three products alike: the kernels hand operands round
/// subgroups.
bool can_winograd(const ConvShape& shape, WinogradTile tile, const Caps& caps);

/// Bytes of scratch that record_winograd_product takes.
uint64_t winograd_product_scratch(const ConvShape& shape, ConvDirection direction, WinogradTile tile,
                                  const Caps& caps);
/// Records the product that record_conv_product makes. The shape must be one that can_winograd.
void record_winograd_product(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                             const ConvOperands& operands, Slice scratch, WinogradTile tile);
/// Estimated nanoseconds of it on `threads` threads of a CPU.
double winograd_product_cost(const ConvShape& shape, ConvDirection direction, WinogradTile tile,
                             const Caps& caps, int64_t threads);

/// The same of the weight gradient, which record_weight_gradient makes directly.
uint64_t winograd_weight_gradient_scratch(const ConvShape& shape, WinogradTile tile, const Caps& caps);
void record_winograd_weight_gradient(Recorder& recorder, const ConvShape& shape, const Slice& x,
                                     const Slice& dy, const Slice& dw, uint32_t accumulate,
                                     const Slice& scratch, WinogradTile tile);
double winograd_weight_gradient_cost(const ConvShape& shape, WinogradTile tile, const Caps& caps,
                                     int64_t threads);

}  // namespace vkopple
