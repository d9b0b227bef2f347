#pragma once

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_push.h"
#include "graph/conv/conv_tuning.h"

namespace vkopple {

/// The kernels of GPUs for a convolution's products: tiles of both operands lie in shared memory, where all of
/// a workgroup's invocations read them. Sums have the order of conv_product's. Any shape.

/// Whether a tile fits the device; one does wherever Vulkan's minimum limits hold.
bool can_conv_shared(const Caps& caps);

/// Bytes of scratch, for packed weights.
uint64_t conv_shared_scratch(const ConvShape& shape, ConvDirection direction);

/// What can be tuned.
ConvTuning conv_shared_tuning(const ConvShape& shape, ConvDirection direction, const ProductPush& push,
                              const Caps& caps, ConvStorage storage);

/// Records one product; `push` describes the product but for tiles and bias.
void record_conv_shared(Recorder& recorder, const ConvShape& shape, ConvDirection direction, ProductPush push,
                        const ConvOperands& operands, const Slice& scratch);

}  // namespace vkopple
