#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// y[e] (+)= scale times the sum over r of x[position of (e, r)], or of x times w. e numbers the kept axes, r the summed ones, each in
// row-major order. r is cut into strips: invocation (strip, e) sums one of them, into y[strip kept + e]. The order is fixed.
layout(constant_id = 1) const bool kWeighted = false;

layout(push_constant) uniform Push {
  uint kept;    // elements e
  uint summed;  // elements r
  uint strip;   // elements r of one strip
  uint strips;
  uint kept_axes;
  uint axes;
  float scale;
  uint accumulate;
  uint sizes[6];  // kept axes first, then summed ones
  uint x_strides[6];
  uint w_strides[6];
} p;

READ1(0, x)
READ1(1, w)
WRITE1(2, y)

// Offsets in x and w of element i of axes first … last - 1.
uvec2 position(uint i, uint first, uint last) {
  uvec2 at = uvec2(0);
  for (uint axis = last; axis-- > first;) {
    uint size = p.sizes[axis];
    uint index = i % size;
    i /= size;
    at += index * uvec2(p.x_strides[axis], p.w_strides[axis]);
  }
  return at;
}

void main() {
  uint i = flat_index();
  if (i >= p.kept * p.strips) return;
  uvec2 base = position(i % p.kept, 0, p.kept_axes);
  uint begin = i / p.kept * p.strip;
  uint end = min(begin + p.strip, p.summed);
  float sum = 0.0;
  // Sums of 32, then their sum: rounding grows with the number of sums, not of elements.
  for (uint first = begin; first < end; first += 32) {
    float part = 0.0;
    for (uint r = first; r < min(first + 32, end); ++r) {
      uvec2 at = base + position(r, p.kept_axes, p.axes);
      float v = load1(x, at.x);
      if (kWeighted) v *= load1(w, at.y);
      part += v;
    }
    sum += part;
  }
  add1(y, i, p.scale * sum, p.accumulate)
}
