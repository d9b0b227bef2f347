#pragma once

#include <cmath>
#include <cstdint>

namespace vkopple {

/// A dropout rate as the kernels take it (shaders/include/random.glsl): a word is dropped where its random bits
/// are below `threshold`, and multiplied by `scale` elsewhere.
struct DropoutRate {
  uint32_t threshold = 0;
  float scale = 1;

  DropoutRate() = default;
  /// rate in [0, 1).
  explicit DropoutRate(float rate)
      : threshold(static_cast<uint32_t>(std::lround(static_cast<double>(rate) * 4294967296.0))),
        scale(static_cast<float>(1.0 / (1.0 - static_cast<double>(rate)))) {}
};

}  // namespace vkopple
