#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vkopple {

/// The bits of the nearest float16 (IEEE 754 binary16), ties to even: what shaders/include/float16.glsl gives.
uint16_t float16_bits(float value);
/// Exact.
float float16_value(uint16_t bits);

/// An even number of values, two in a word, and back.
std::vector<float> to_float16(std::span<const float> values);
std::vector<float> from_float16(std::span<const float> words);

/// Unit round-off of float16: storing a normal number changes it by at most this part of it.
constexpr double kFloat16Roundoff = 1.0 / 2048;

}  // namespace vkopple
