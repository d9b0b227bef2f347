// variants: words vec4s
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#ifdef VEC4S
#define WIDE
#endif
#include "flat_any.glsl"
#include "lanes.glsl"

// y = scale x + offset. One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  float scale;
  float offset;
  uint pixels;
  uint blocks;
  uint last;
} p;

READ(0, x)
WRITE(1, y)

void main() {
  FOR4(i, flat_index() * 4, p.units, {
    VALUE v = p.scale * LOAD(x, i) + p.offset;
    STORE(y, i, v * LANE_MASK(i, p.pixels, p.blocks, p.last))
  })
}
