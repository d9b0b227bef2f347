#pragma once

#include <cstdint>

namespace vkopple {

/// How the floats of a tensor lie in memory. Kernels compute in float32 whatever it is; float16 holds vectors
/// of 4 (READ4 and WRITE4 of shaders/include/access.glsl), never single numbers.
enum class Storage : uint8_t {
  kFloat32,  ///< 32-bit words: floats, and integers too
  kFloat16,  ///< IEEE 754 binary16, rounded to nearest even when stored
};

inline uint64_t element_bytes(Storage storage) { return storage == Storage::kFloat16 ? 2 : 4; }

}  // namespace vkopple
