// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// Raw numbers l to (rho sin theta, rho cos theta, height). Forward: one invocation a slot; backward: one a raw number.
layout(push_constant) uniform Push {
  uint count;
  uint numbers;
  float max_angle;
  float max_depth;
  float max_height;
  uint accumulate;
} p;

READ1(0, raw)
#ifdef FORWARD
WRITE1(1, location)
#else
READ1(1, d_location)
WRITE1(2, d_raw)
#endif

// From -1 to 1.
float both_signs(float s) { return 2.0 * s - 1.0; }

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
#ifdef FORWARD
  uint slot = i;
#else
  uint slot = i / p.numbers;
  uint which = i - slot * p.numbers;
  if (which >= 3u) {
    if (p.accumulate == 0u) d_raw[i] = 0.0;
    return;
  }
#endif
  uint first = slot * p.numbers;
  vec3 s = vec3(precise_sigmoid(load1(raw, first)), precise_sigmoid(load1(raw, first + 1u)),
                precise_sigmoid(load1(raw, first + 2u)));
  vec2 direction = precise_cos_sin(p.max_angle * both_signs(s.x));
  float rho = p.max_depth * s.y;
#ifdef FORWARD
  location[slot * 3u] = rho * direction.y;
  location[slot * 3u + 1u] = rho * direction.x;
  location[slot * 3u + 2u] = p.max_height * both_signs(s.z);
#else
  vec3 d = vec3(load1(d_location, slot * 3u), load1(d_location, slot * 3u + 1u), load1(d_location, slot * 3u + 2u));
  vec3 slope = s * (1.0 - s);
  float gradient;
  if (which == 0u) gradient = rho * (d.x * direction.x - d.y * direction.y) * p.max_angle * 2.0 * slope.x;
  else if (which == 1u) gradient = (d.x * direction.y + d.y * direction.x) * p.max_depth * slope.y;
  else gradient = d.z * p.max_height * 2.0 * slope.z;
  add1(d_raw, i, gradient, p.accumulate)
#endif
}
