// variants: forward forward4 backward backward4
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#include "leaky.glsl"
#if defined(FORWARD4) || defined(BACKWARD4)
#define WIDE
#endif
#include "flat_any.glsl"

// y = max(x, slope x); dx = dy where y > 0, slope dy elsewhere. One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  float slope;
  uint accumulate;
} p;

#if defined(FORWARD) || defined(FORWARD4)
READ(0, x)
WRITE(1, y)
#else
READ(0, y)
READ(1, dy)
WRITE(2, dx)
#endif

void main() {
  uint first = flat_index() * 4;
#if defined(FORWARD) || defined(FORWARD4)
  FOR4(i, first, p.units, { VALUE v = LOAD(x, i); STORE(y, i, v * leaky_slope(v, p.slope)) })
#else
  FOR4(i, first, p.units, { VALUE v = LOAD(y, i); ADD(dx, i, leaky_slope(v, p.slope) * LOAD(dy, i), p.accumulate) })
#endif
}
