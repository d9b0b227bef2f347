#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// y = T x or T' x with the matrix T that the batch's entry names. One invocation an element of y.
layout(push_constant) uniform Push {
  uint count;
  uint slots;
  uint bins;
  uint matrices;
  uint transposed;
  uint accumulate;
} p;

READ1(0, x)
READ1(1, table)
READU(2, index)
WRITE1(3, y)

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint row = i / p.bins;
  uint m = i - row * p.bins;
  uint matrix = min(index[row / p.slots], p.matrices - 1u) * p.bins * p.bins;
  uint at = matrix + (p.transposed != 0u ? m : m * p.bins);
  uint step_ = p.transposed != 0u ? p.bins : 1u;
  PreciseSum sum = PreciseSum(0.0, 0.0);
  for (uint n = 0u; n < p.bins; ++n) add_product_to(sum, load1(table, at + n * step_), load1(x, row * p.bins + n));
  add1(y, i, value_of(sum), p.accumulate)
}
