// variants: forward forward4 backward backward4
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#include "precise4.glsl"
#include "normal.glsl"
#if defined(FORWARD4) || defined(BACKWARD4)
#define WIDE
#endif
#include "flat_any.glsl"

// y = x P(x), P the share of the normal distribution below x; dx = (P(x) + x p(x)) dy, p its density. Zero stays zero, padding
// with it. One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  uint accumulate;
} p;

READ(0, x)
#if defined(FORWARD) || defined(FORWARD4)
WRITE(1, y)
#else
READ(1, dy)
WRITE(2, dx)
#endif

void main() {
#if defined(FORWARD) || defined(FORWARD4)
  FOR4(i, flat_index() * 4, p.units, {
    VALUE v = LOAD(x, i);
    STORE(y, i, v * normal_below(v))
  })
#else
  FOR4(i, flat_index() * 4, p.units, {
    VALUE v = LOAD(x, i);
    ADD(dx, i, LOAD(dy, i) * (normal_below(v) + v * normal_density(v)), p.accumulate)
  })
#endif
}
