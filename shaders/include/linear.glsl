// What the plain kernels of y = x wᵀ + b share: x (rows, inputs), w (outputs, inputs), y (rows, outputs), all row-major, x and y from an
// offset in elements on. Every operand read in fours has two bindings, name4 and name1: vectors where kVectorInputs or kVectorOutputs
// says that rows of `inputs` or `outputs` elements start at multiples of 4, else single elements.
#include "row4.glsl"
layout(constant_id = 1) const uint kVectorInputs = 1;
layout(constant_id = 2) const uint kVectorOutputs = 1;
layout(push_constant) uniform Push {
  uint rows;
  uint inputs;
  uint outputs;
  uint x_offset;
  uint y_offset;
  uint accumulate;
} p;

// Terms of a sum that are added up before the total takes them: keeps the rounding of long sums small.
const uint kRun = 256;

// Elements i … i + 3 of a row of `count` that starts at `at`; zeros beyond its end. In vectors, i must be below `count`.
#define row4(name, vectors, at, i, count) \
  ((vectors) != 0 ? load4(name##4, ((at) + (i)) >> 2) : singles4(name##1, true, (at) + (i), 1, i, count))
