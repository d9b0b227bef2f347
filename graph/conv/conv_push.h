#pragma once

#include <cstdint>

namespace vkopple {

/// Push constants of a convolution's products, as conv_product.comp and conv_shared.comp explain them.
struct ProductPush {
  int32_t n, in4, out4, h, w, out_h, out_w;
  int32_t kernel, stride, step, tap_step, phases;
  int32_t first[2], taps[2], base[2];
  int32_t tiles, bias;
};

}  // namespace vkopple
