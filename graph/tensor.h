#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/shape.h"
#include "runtime/storage.h"

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
  Storage storage = Storage::kFloat32;  ///< kFloat16: NC4HW4 tensors of floats alone

  /// Elements it takes, padding included.
  uint64_t elements() const;
  /// Bytes it takes, padding included.
  uint64_t bytes() const { return elements() * element_bytes(storage); }
  bool operator==(const TensorSpec&) const = default;
};

inline TensorSpec row_major(const Shape& shape) {
  return {.shape = shape, .layout = Layout::kRowMajor, .dtype = DType::kF32};
}
inline TensorSpec channels4(const Shape& shape) {
  return {.shape = shape, .layout = Layout::kChannels4, .dtype = DType::kF32};
}
inline TensorSpec unsigned_ints(const Shape& shape) {
  return {.shape = shape, .layout = Layout::kRowMajor, .dtype = DType::kU32};
}
/// The same tensor in another storage, if it is one of those that may be float16.
inline TensorSpec stored_as(TensorSpec spec, Storage storage) {
  if (spec.layout == Layout::kChannels4 && spec.dtype == DType::kF32) spec.storage = storage;
  return spec;
}

/// Vectors of 4 channels that hold C channels.
inline int64_t blocks4(int64_t channels) { return (channels + 3) / 4; }

/// Between the host's row-major values and the bytes of a layout and storage (in 32-bit words; u32 values are
/// copied bit for bit, and two float16 share a word).
std::vector<float> to_layout(const TensorSpec& spec, std::span<const float> row_major_values);
std::vector<float> from_layout(const TensorSpec& spec, std::span<const float> stored);

}  // namespace vkopple
