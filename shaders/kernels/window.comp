#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// Of NC4HW4 tensors: to(n, c, y, x) (+)= from(n, c, y + top, x + left), zero outside of `from`.
// One invocation takes 4 consecutive vec4s of `to`.
layout(push_constant) uniform Push {
  uint vec4s;  // of `to`
  uint from_height;
  uint from_width;
  uint to_height;
  uint to_width;
  int top;
  int left;
  uint accumulate;
} p;

READ4(0, from)
WRITE4(1, to)

void main() {
  FOR4(i, flat_index() * 4, p.vec4s, {
    uint row = i / p.to_width;
    uint plane = row / p.to_height;
    // Negative positions wrap around to huge ones.
    uint y = row - plane * p.to_height + uint(p.top);
    uint x = i - row * p.to_width + uint(p.left);
    bool inside = y < p.from_height && x < p.from_width;
    vec4 v = load4_or_zero(from, inside, (plane * p.from_height + y) * p.from_width + x);
    add4(to, i, v, p.accumulate)
  })
}
