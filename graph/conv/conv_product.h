#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "graph/conv/conv_shape.h"
#include "graph/conv/conv_tuning.h"
#include "runtime/recorder.h"

namespace vkopple {

/// Which of a convolution's tensors a product makes; both are NC4HW4 and take a bias per channel made.
enum class ConvDirection {
  kForward,     ///< y (n, co, ho, wo) from x and w
  kTransposed,  ///< x (n, ci, h, w) from y and w: the gradient of x, and the transposed convolution
};

struct ConvOperands {
  Slice in;    ///< x, or y for kTransposed
  Slice w;     ///< (co, ci, kernel, kernel), row-major
  Slice bias;  ///< row-major, one for each channel of `out`; may be empty
  Slice out;
  uint32_t accumulate = 0;  ///< 1: out += …

  ConvStorage storage(ConvDirection direction) const {
    return direction == ConvDirection::kForward ? ConvStorage{in.storage, out.storage}
                                                : ConvStorage{out.storage, in.storage};
  }
};

/// Families of kernels, by the mechanism that brings weights to invocations of the same output channels.
///   "shuffle"  each lane fetches 1 / 8 of the weights and hands them round the subgroup (devices of CPU type)
///   "window"   the same, and a stretch of an input row serves all columns of the kernel (conv_window.h)
///   "uniform"  all lanes load the same address; runs anywhere
///   "shared"   a workgroup brings tiles of both operands to shared memory (GPUs; conv_shared.h)
///   "cooperative"  subgroups multiply matrices of float16 (GPUs that can; conv_cooperative.h)
/// An empty name lets Caps and the storage of `in` choose.
bool is_conv_kernel(std::string_view kernel);
/// Whether the device can run the family.
bool can_run_conv_kernel(std::string_view kernel, const Caps& caps);

/// Bytes of scratch that record_conv_product takes, for packed weights.
uint64_t conv_product_scratch(const ConvShape& shape, ConvDirection direction);

/// What can be tuned, where the family that runs has tiles to choose.
std::optional<ConvTuning> conv_product_tuning(const ConvShape& shape, ConvDirection direction, const Caps& caps,
                                              ConvStorage storage = {});

/// Records one product. Stride 1 or 2 (for kForward any), any kernel, padding and dilation. Throws Error for a
/// kernel that the device can't run.
void record_conv_product(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                         const ConvOperands& operands, Slice scratch, std::string_view kernel = {});

}  // namespace vkopple
