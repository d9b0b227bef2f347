// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = -(1 / B) sum over b and k < l of min(|x_bk - x_bl|, 1), x the first of (B, K, 3)'s coordinates. Where that distance
// is at most 1, its slope by x_bk is sign(x_bk - x_bl). One invocation takes one (b, k).
layout(push_constant) uniform Push {
  uint count;  // B K
  uint slots;
  float scale;  // -1 / B
  uint accumulate;
} p;

READ1(0, x)
#ifdef FORWARD
WRITE1(1, terms)
#else
READ1(1, dloss)
WRITE1(2, dx)
#endif

float across(uint i) { return load1(x, 3 * i); }

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint first = i - i % p.slots;  // slot 0 of this image
  float here = across(i), sum = 0.0;
#ifdef FORWARD
  for (uint l = first; l < i; ++l) sum += min(abs(here - across(l)), 1.0);
  terms[i] = sum;
#else
  for (uint l = first; l < first + p.slots; ++l) {
    float d = here - across(l);
    if (abs(d) <= 1.0) sum += sign(d);
  }
  vec3 slope = vec3(p.scale * load1(dloss, 0) * sum, 0, 0);
  for (uint axis = 0; axis < 3; ++axis) add1(dx, 3 * i + axis, slope[axis], p.accumulate)
#endif
}
