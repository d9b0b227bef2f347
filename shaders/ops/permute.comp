#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// y[i] = x[j], j made of i's indices by x's strides. One invocation takes 4 consecutive words of y.
layout(constant_id = 1) const uint kAxes = 1;
layout(push_constant) uniform Push {
  uint words;
  uint accumulate;
  uint sizes[6];
  uint strides[6];
} p;

READ1(0, x)
WRITE1(1, y)

uint source(uint i) {
  uint at = 0u;
  for (uint k = kAxes; k > 0u; --k) {
    uint size = p.sizes[k - 1u];
    uint outer = i / size;
    at += (i - outer * size) * p.strides[k - 1u];
    i = outer;
  }
  return at;
}

void main() {
  uint first = flat_index() * 4;
  FOR4(i, first, p.words, { add1(y, i, load1(x, source(i)), p.accumulate) })
}
