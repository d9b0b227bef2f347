#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// y = T x or T' x with the circulant matrix T[m, n] = row[(n - m) mod bins] whose row the batch's entry names. One invocation an
// element of y.
layout(push_constant) uniform Push {
  uint count;
  uint slots;
  uint bins;
  uint rows;
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
  uint first = min(index[row / p.slots], p.rows - 1u) * p.bins;
  PreciseSum sum = PreciseSum(0.0, 0.0);
  for (uint n = 0u; n < p.bins; ++n) {
    uint forth = p.transposed != 0u ? m + p.bins - n : n + p.bins - m;
    add_product_to(sum, load1(table, first + (forth < p.bins ? forth : forth - p.bins)), load1(x, row * p.bins + n));
  }
  add1(y, i, value_of(sum), p.accumulate)
}
