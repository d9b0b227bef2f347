#pragma once

#include "graph/op.h"

namespace vkopple {

/// Sizes as kernels take them. The executor's limit on bindings keeps every tensor below 2^31 elements.
inline uint32_t u32(int64_t size) { return static_cast<uint32_t>(size); }
inline uint32_t u32(uint64_t size) { return static_cast<uint32_t>(size); }

/// Elements that a tensor takes, padding included: 32-bit words, or half of one each in float16.
inline uint32_t words(const TensorSpec& spec) { return u32(spec.elements()); }
inline uint32_t words(const Operand& operand) { return words(operand.spec); }

/// What kernels that treat words alike must know of padding: vec4 number i belongs to channel block
/// (i / pixels) % blocks, of which the last has `last` channels. Without padding, last is 4 (lanes.glsl).
struct Lanes {
  uint32_t pixels = 1;
  uint32_t blocks = 1;
  uint32_t last = 4;
};

inline Lanes lanes_of(const TensorSpec& spec) {
  if (spec.layout == Layout::kRowMajor) return {};
  return {u32(spec.shape[2] * spec.shape[3]), u32(blocks4(spec.shape[1])), u32((spec.shape[1] - 1) % 4 + 1)};
}

}  // namespace vkopple
