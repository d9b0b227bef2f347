#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/shape.h"

namespace vkopple {

enum class DType { kF32, kU32 };

enum class Layout {
  kRowMajor,   ///< the last axis innermost
  kChannels4,  ///< NC4HW4: (N, C, H, W) as [n][c / 4][y][x] vec4 of 4 channels; lanes beyond C hold zeros,
               ///< always
};

/// What a tensor is, without where it lies.
struct TensorSpec {
  Shape shape;
  Layout layout = Layout::kRowMajor;
  DType dtype = DType::kF32;

  /// Bytes it takes, padding included.
  uint64_t bytes() const;
  bool operator==(const TensorSpec&) const = default;
};

inline TensorSpec row_major(const Shape& shape) { return {shape, Layout::kRowMajor, DType::kF32}; }
inline TensorSpec channels4(const Shape& shape) { return {shape, Layout::kChannels4, DType::kF32}; }
inline TensorSpec unsigned_ints(const Shape& shape) { return {shape, Layout::kRowMajor, DType::kU32}; }

/// Vectors of 4 channels that hold C channels.
inline int64_t blocks4(int64_t channels) { return (channels + 3) / 4; }

/// Between the host's row-major values and the bytes of a layout (in 32-bit words; u32 values are copied bit
/// for bit).
std::vector<float> to_layout(const TensorSpec& spec, std::span<const float> row_major_values);
std::vector<float> from_layout(const TensorSpec& spec, std::span<const float> stored);

}  // namespace vkopple
