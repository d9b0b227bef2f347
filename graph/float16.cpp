#include "graph/float16.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace vkopple {

uint16_t float16_bits(float value) {
  const auto bits = std::bit_cast<uint32_t>(value);
  const uint32_t sign = bits >> 16 & 0x8000U;
  const uint32_t size = bits & 0x7fffffffU;
  if (size > 0x7f800000U) return static_cast<uint16_t>(sign | 0x7e00U);
  if (size >= 0x47800000U) return static_cast<uint16_t>(sign | 0x7c00U);
  if (size < 0x38800000U)  // steps of 2^-24
    return static_cast<uint16_t>(
        sign | static_cast<uint32_t>(std::nearbyint(std::ldexp(static_cast<double>(std::abs(value)), 24))));
  return static_cast<uint16_t>(sign | (size - 0x38000000U + 0xfffU + (size >> 13 & 1U)) >> 13);
}

float float16_value(uint16_t bits) {
  const uint32_t exponent = bits >> 10 & 31U;
  const uint32_t fraction = bits & 1023U;
  const float sign = (bits & 0x8000U) != 0 ? -1.0F : 1.0F;
  if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
  return sign * std::ldexp(static_cast<float>(1024 + fraction), static_cast<int>(exponent) - 25);
}

std::vector<float> to_float16(std::span<const float> values) {
  std::vector<uint16_t> bits;
  bits.reserve(values.size());
  for (const float value : values) bits.push_back(float16_bits(value));
  std::vector<float> words(values.size() / 2);
  std::memcpy(words.data(), bits.data(), words.size() * 4);
  return words;
}

std::vector<float> from_float16(std::span<const float> words) {
  std::vector<uint16_t> bits(words.size() * 2);
  std::memcpy(bits.data(), words.data(), words.size() * 4);
  std::vector<float> values;
  values.reserve(bits.size());
  for (const uint16_t b : bits) values.push_back(float16_value(b));
  return values;
}

}  // namespace vkopple
