#pragma once

#include <cstdint>

namespace vkopple {

/// A product y = x wᵀ + b as linear.glsl has it; offsets in elements, of x and y and their gradients alike.
struct LinearPush {
  uint32_t rows;
  uint32_t inputs;
  uint32_t outputs;
  uint32_t x_offset;
  uint32_t y_offset;
  uint32_t accumulate;

  /// Whether rows of x, or of y, start at multiples of 4 elements.
  bool vector_inputs() const { return inputs % 4 == 0 && x_offset % 4 == 0; }
  bool vector_outputs() const { return outputs % 4 == 0 && y_offset % 4 == 0; }
};

}  // namespace vkopple
