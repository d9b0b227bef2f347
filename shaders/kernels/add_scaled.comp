// variants: words vec4s
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#ifdef VEC4S
#define WIDE
#endif
#include "flat_any.glsl"

// to (+)= scale from. One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  float scale;
  uint accumulate;
} p;

READ(0, from)
WRITE(1, to)

void main() {
  FOR4(i, flat_index() * 4, p.units, { ADD(to, i, p.scale * LOAD(from, i), p.accumulate) })
}
