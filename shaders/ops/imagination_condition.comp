// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Rows (ego 3, velocity x y, direction 2), the background's (ego, 0, 0, 1, 0). One invocation takes one row.
layout(push_constant) uniform Push {
  uint rows;   // B (K + 1)
  uint slots;  // K
  uint want_velocity;
  uint want_direction;
  uint accumulate_velocity;
  uint accumulate_direction;
} p;

#ifdef FORWARD
READ1(0, ego)
READ1(1, velocity)
READ1(2, direction)
WRITE1(3, condition)
#else
READ1(0, dcondition)
WRITE1(1, dvelocity)
WRITE1(2, ddirection)
#endif

void main() {
  uint row = flat_index();
  if (row >= p.rows) return;
  uint image = row / (p.slots + 1);
  uint slot = row - image * (p.slots + 1);
  uint object = image * p.slots + slot;  // of (B, K)
#ifdef FORWARD
  vec4 motion = vec4(0, 0, 1, 0);
  if (slot < p.slots)
    motion = vec4(load1(velocity, object * 3), load1(velocity, object * 3 + 1), load1(direction, object * 2),
                  load1(direction, object * 2 + 1));
  for (uint c = 0; c < 3; ++c) condition[row * 7 + c] = load1(ego, image * 3 + c);
  for (uint c = 0; c < 4; ++c) condition[row * 7 + 3 + c] = motion[c];
#else
  if (slot == p.slots) return;
  for (uint c = 0; c < 3; ++c)
    if (p.want_velocity != 0)
      add1(dvelocity, object * 3 + c, c < 2 ? load1(dcondition, row * 7 + 3 + c) : 0.0, p.accumulate_velocity)
  for (uint c = 0; c < 2; ++c)
    if (p.want_direction != 0)
      add1(ddirection, object * 2 + c, load1(dcondition, row * 7 + 5 + c), p.accumulate_direction)
#endif
}
