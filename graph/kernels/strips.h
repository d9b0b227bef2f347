#pragma once

#include <algorithm>
#include <cstdint>

namespace vkopple {

/// Invocations that share the pixels of one sum in a kernel's first stage; a second one adds what they leave,
/// in order. 64 pixels to each, more where that leaves the second stage too many of them.
inline uint32_t pixel_strips(uint32_t pixels) {
  constexpr uint32_t kPixels = 64;
  constexpr uint32_t kMost = 512;
  return std::min(kMost, (pixels + kPixels - 1) / kPixels);
}

}  // namespace vkopple
