#pragma once

#include <functional>
#include <string>

#include "models/layers.h"

namespace vkopple {

/// What follows a convolution: dropout(norm(leaky_relu(x))), or dropout(leaky_relu(x)) without a norm. `name`
/// is the norm's.
using Norm = std::function<Value(Value x, const std::string& name)>;

/// conv3 → LeakyReLU at full resolution.
Value in_conv(LayerFactory& layers, Value x, int64_t channels);

/// mid = norm(conv3(x)); norm(conv3 stride 2 of (mid + x)): H and W become ⌈H/2⌉, ⌈W/2⌉ (docs/model.md §2.1).
Value down(LayerFactory& layers, Value x, const std::string& name, int64_t channels, const Norm& norm);

struct UpOptions {
  int64_t kernel = 3;     ///< of the transposed convolution
  bool residual = false;  ///< adds the upsampled tensor to the result
  int64_t inner = 0;      ///< samples a run where the skip serves several runs of x (see add_repeated)
};

/// u = norm(tconv(x)), cropped to the size of `level`, the tensor of the same level on the way down;
/// norm(conv3([skip, u])). An empty skip leaves it out.
Value up(LayerFactory& layers, Value x, Shape level, Value skip, const std::string& name, int64_t channels,
         const Norm& norm, const UpOptions& options);

}  // namespace vkopple
