// variants: words vec4s
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#ifdef VEC4S
#define WIDE
#endif
#include "flat_any.glsl"

// to[o to_stride + to_begin + r] (+)= from[o from_stride + from_begin + r] for r < run; sizes in units, that is words or vec4s.
// One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  uint run;
  uint from_stride;
  uint from_begin;
  uint to_stride;
  uint to_begin;
  uint accumulate;
} p;

READ(0, from)
WRITE(1, to)

void main() {
  FOR4(i, flat_index() * 4, p.units, {
    uint o = i / p.run;
    uint r = i - o * p.run;
    ADD(to, o * p.to_stride + p.to_begin + r, LOAD(from, o * p.from_stride + p.from_begin + r), p.accumulate)
  })
}
