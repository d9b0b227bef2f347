#pragma once

#include <cmath>
#include <cstdint>

namespace vkopple {

/// Focal length in pixels of an image `height` pixels high that spans `fov` radians vertically (docs/model.md,
/// geometry).
inline double focal_length(int64_t height, float fov) {
  return static_cast<double>(height) / 2 / std::tan(static_cast<double>(fov) / 2);
}

/// Half the pixel grid's extent: the pixel of column c lies at c − centre(width).
inline float centre(int64_t size) { return static_cast<float>(size - 1) / 2; }

/// Whether a field of view makes a pinhole camera.
inline bool is_fov(float fov) { return fov > 0.0F && fov < 3.14F; }

}  // namespace vkopple
