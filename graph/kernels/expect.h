#pragma once

#include "graph/tensor.h"

namespace vkopple {

/// Whether a tensor holds row-major floats, of a given rank or shape.
inline bool row_floats(const TensorSpec& spec, size_t rank) {
  return spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32 && spec.shape.rank() == rank;
}
inline bool row_floats(const TensorSpec& spec, const Shape& shape) { return spec == row_major(shape); }

}  // namespace vkopple
