#pragma once

#include <string_view>

#include "graph/conv/conv_product.h"
#include "graph/op.h"

namespace vkopple {

/// What the ops conv2d and conv_transpose2d share: with inputs x, w and, where has_bias, b, one makes the y of
/// a convolution (ConvDirection::kForward) and the other its x (kTransposed). `kernel` as convolution.h has it.
struct ConvOp {
  ConvShape shape;
  ConvDirection makes;
  bool has_bias;
  std::string_view kernel;

  Needs needs(const Caps& caps) const;
  void record_forward(Recorder& recorder, const Forward& io) const;
  void record_backward(Recorder& recorder, const Backward& io) const;
};

}  // namespace vkopple
