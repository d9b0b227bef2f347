#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "graph/checks/check.h"

namespace vkopple {

/// The integers of shaders/include/random.glsl on the host, for references.
class CheckRandom {
 public:
  CheckRandom(uint32_t seed, uint32_t step, uint32_t stream)
      : low_(mix(mix(mix(seed + 0x9e3779b9U) + step) + stream)),
        high_(mix(mix(mix(stream + 0x7f4a7c15U) + seed) + step)) {}

  uint32_t bits(uint32_t index) const {
    uint32_t v = index + low_;
    v ^= v >> 16;
    v *= 0x85ebca6bU;
    v ^= v >> 13;
    v ^= high_;
    v *= 0xc2b2ae35U;
    return v ^ v >> 16;
  }
  /// What dropout multiplies word `index` by.
  double factor(uint32_t index, float rate) const {
    const double p = static_cast<double>(rate);
    return static_cast<double>(bits(index)) < std::round(p * 4294967296.0) ? 0.0 : 1.0 / (1.0 - p);
  }

 private:
  static uint32_t mix(uint32_t v) {
    v ^= v >> 16;
    v *= 0x85ebca6bU;
    v ^= v >> 13;
    v *= 0xc2b2ae35U;
    return v ^ v >> 16;
  }
  uint32_t low_;
  uint32_t high_;
};

/// Where element i of row-major order lies in a tensor's storage, in words.
inline uint32_t storage_word(const TensorSpec& spec, size_t i) {
  if (spec.layout == Layout::kRowMajor) return static_cast<uint32_t>(i);
  const Shape& s = spec.shape;
  const auto at = static_cast<int64_t>(i);
  const int64_t pixels = s[2] * s[3];
  const int64_t channel = at / pixels % s[1];
  const int64_t block = at / (pixels * s[1]) * blocks4(s[1]) + channel / 4;
  return static_cast<uint32_t>((block * pixels + at % pixels) * 4 + channel % 4);
}

/// Multiplies `y` by the dropout mask that `random` = {seed, step} and `stream` give a tensor of this spec.
inline void apply_dropout(HostTensor& y, const TensorSpec& spec, const HostTensor& random, uint32_t stream,
                          float rate) {
  const CheckRandom generator(static_cast<uint32_t>(random.values[0]), static_cast<uint32_t>(random.values[1]),
                              stream);
  for (size_t i = 0; i < y.values.size(); ++i) y.values[i] *= generator.factor(storage_word(spec, i), rate);
}

/// Sets a {seed, step} input; both below 2^24, which survive the check's rounding to float.
inline void set_random(HostTensor& random, uint32_t seed, uint32_t step) {
  random.values = {static_cast<double>(seed), static_cast<double>(step)};
}

}  // namespace vkopple
