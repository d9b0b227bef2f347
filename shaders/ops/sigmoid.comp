// variants: forward forward4 backward backward4
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#include "precise4.glsl"
#if defined(FORWARD4) || defined(BACKWARD4)
#define WIDE
#endif
#include "flat_any.glsl"
#include "lanes.glsl"

// y = scale s(x) + offset with s(x) = 1 / (1 + exp(-x)); dx = scale s (1 - s) dy with s = (y - offset) / scale.
// One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  float scale;
  float offset;
  uint accumulate;
  uint pixels;
  uint blocks;
  uint last;
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
#if defined(FORWARD) || defined(FORWARD4)
  FOR4(i, flat_index() * 4, p.units, {
    VALUE v = p.scale * precise_sigmoid(LOAD(x, i)) + p.offset;
    STORE(y, i, v * LANE_MASK(i, p.pixels, p.blocks, p.last))
  })
#else
  FOR4(i, flat_index() * 4, p.units, {
    VALUE v = LOAD(y, i) - p.offset;
    ADD(dx, i, LOAD(dy, i) * v * (1.0 - v / p.scale), p.accumulate)
  })
#endif
}
