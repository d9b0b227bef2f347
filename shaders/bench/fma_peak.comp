#version 450
#extension GL_GOOGLE_include_directive : require
// As many fused multiply-adds as a device can do: 12 chains per invocation that don't wait for one another, written out
// straight, 96 links a turn, that nothing feeds from memory. One float an invocation is written, so that none is left out.
//   y (invocations)
#include "access.glsl"

WRITE1(0, y)
layout(push_constant) uniform Push {
  uint turns;
  float factor, summand;  // which the compiler can't know
} p;

#define LINK \
  a = fma(a, factor, summand); \
  b = fma(b, factor, summand); \
  c = fma(c, factor, summand);
#define LINKS4 LINK LINK LINK LINK
#define LINKS16 LINKS4 LINKS4 LINKS4 LINKS4
#define LINKS96 LINKS16 LINKS16 LINKS16 LINKS16 LINKS16 LINKS16

void main() {
  uint i = flat_index();
  vec4 factor = vec4(p.factor), summand = vec4(p.summand);
  vec4 a = vec4(i), b = a + 1.0, c = a + 2.0;
  for (uint turn = 0; turn < p.turns; ++turn) { LINKS96 }
  vec4 sum = a + b + c;
  y[i] = sum.x + sum.y + sum.z + sum.w;
}
