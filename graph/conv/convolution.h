#pragma once

#include <cstdint>
#include <string_view>

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_shape.h"
#include "runtime/recorder.h"

namespace vkopple {

/// The ways to compute a convolution's products.
enum class ConvAlgorithm {
  kDirect,     ///< conv_product.h, weight_gradient.h
  kWinograd2,  ///< winograd.h with tiles of 2 x 2 outputs
  kWinograd4,  ///< … of 4 x 4
};

/// "direct", "winograd2", "winograd4".
std::string_view name_of(ConvAlgorithm algorithm);

/// What an op's `kernel` option may say: "winograd2" or "winograd4" for all three products, or a family of
/// direct kernels (conv_product.h); empty leaves the choice to this file.
bool is_convolution_kernel(std::string_view kernel);
/// Whether the device can run it on this shape.
bool can_run_convolution(std::string_view kernel, const ConvShape& shape, const Caps& caps);

/// The algorithm that is taken: the one that `kernel` forces, else the one that Caps::winograd forces where it
/// can run, else the one estimated to be fastest. Devices that keep exact sums stay direct; so do, unless
/// forced, those of types other than CPU and those held to other families of kernels. Throws Error for a kernel
/// that the device can't run on this shape.
ConvAlgorithm choose_convolution(const ConvShape& shape, ConvDirection direction, const Caps& caps,
                                 std::string_view kernel = {});
ConvAlgorithm choose_weight_gradient(const ConvShape& shape, const Caps& caps, std::string_view kernel = {});

/// Bytes of scratch for record_convolution and record_convolution_weight_gradient.
uint64_t convolution_scratch(const ConvShape& shape, ConvDirection direction, const Caps& caps,
                             std::string_view kernel = {});
uint64_t convolution_weight_gradient_scratch(const ConvShape& shape, const Caps& caps,
                                             std::string_view kernel = {});

/// As record_conv_product and record_weight_gradient, by the algorithm chosen.
void record_convolution(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                        const ConvOperands& operands, Slice scratch, std::string_view kernel = {});
void record_convolution_weight_gradient(Recorder& recorder, const ConvShape& shape, Slice x, Slice dy, Slice dw,
                                        uint32_t accumulate, Slice scratch, std::string_view kernel = {});

}  // namespace vkopple
