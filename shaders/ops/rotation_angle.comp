// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// The angle of (cosine, sine) scaled by q + 1e-8. One invocation a slot.
layout(push_constant) uniform Push {
  uint slots;
  uint wants_direction;
  uint wants_q;
  uint accumulate_direction;
  uint accumulate_q;
} p;

READ1(0, direction)
READ1(1, q)
#ifdef FORWARD
WRITE1(2, angle)
#else
READ1(2, d_angle)
WRITE1(3, d_direction)
WRITE1(4, d_q)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.slots) return;
  vec2 e = vec2(load1(direction, i * 2u), load1(direction, i * 2u + 1u));
  float scale = load1(q, i) + 1e-8;
  float whole = precise_atan2(e.y, e.x);
#ifdef FORWARD
  angle[i] = whole * scale;
#else
  float d = load1(d_angle, i);
  if (p.wants_q != 0u) add1(d_q, i, d * whole, p.accumulate_q)
  if (p.wants_direction == 0u) return;
  float square = dot(e, e);
  vec2 gradient = square > 0.0 ? d * scale / square * vec2(-e.y, e.x) : vec2(0);
  add1(d_direction, i * 2u, gradient.x, p.accumulate_direction)
  add1(d_direction, i * 2u + 1u, gradient.y, p.accumulate_direction)
#endif
}
