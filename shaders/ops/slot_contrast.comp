// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = -(1 / B) sum over b and k < l of min(|x_bk - x_bl|_1, 1); x (B, K, 3). Where a norm n <= 1, its slope by x_bk is
// sign(x_bk - x_bl). One invocation takes one (b, k).
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

vec3 location(uint i) { return vec3(load1(x, 3 * i), load1(x, 3 * i + 1), load1(x, 3 * i + 2)); }

float norm(vec3 d) { return dot(abs(d), vec3(1)); }

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint first = i - i % p.slots;  // slot 0 of this image
  vec3 here = location(i);
#ifdef FORWARD
  float sum = 0.0;
  for (uint l = first; l < i; ++l) sum += min(norm(here - location(l)), 1.0);
  terms[i] = sum;
#else
  vec3 sum = vec3(0);
  for (uint l = first; l < first + p.slots; ++l) {
    vec3 d = here - location(l);
    if (norm(d) <= 1.0) sum += sign(d);
  }
  float factor = p.scale * load1(dloss, 0);
  for (uint axis = 0; axis < 3; ++axis) add1(dx, 3 * i + axis, factor * sum[axis], p.accumulate)
#endif
}
