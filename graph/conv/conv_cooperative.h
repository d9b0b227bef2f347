#pragma once

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_push.h"

namespace vkopple {

/// The kernels of devices with cooperative matrices (Caps::cooperative_matrices) for a convolution's products.
/// Weights are rounded to float16, and `in` too where it is stored as float32; products are exact and added in
/// float32, in an order and with a rounding of the device's own. Any shape.

/// Bytes of scratch, for packed weights.
uint64_t conv_cooperative_scratch(const ConvShape& shape, ConvDirection direction);

/// Records one product; `push` describes the product but for tiles and bias.
void record_conv_cooperative(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                             ProductPush push, const ConvOperands& operands, const Slice& scratch);

}  // namespace vkopple
