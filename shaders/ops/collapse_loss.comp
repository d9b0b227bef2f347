// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = -(1 / B) sum over (b, k) of q_bk min(n_bk, 1), n_bk = |x1[perm b, k] - x3[b, k]|_1; x1 and x3 (B, K, 3), q (B, K).
// Where n <= 1: dx3 = -scale q sign(x1 - x3) dloss, and dx1 gathers the opposite of it from every b that perm sends to its sample.
// One invocation takes one (b, k).
layout(push_constant) uniform Push {
  uint batch;
  uint slots;
  float scale;  // -1 / B
  uint wants;   // bit i of these speaks of input i
  uint accumulates;
} p;

READ1(0, x1)
READ1(1, x3)
READ1(2, q)
READU(3, perm)
#ifdef FORWARD
WRITE1(4, terms)
#else
READ1(4, dloss)
WRITE1(5, dx1)
WRITE1(6, dx3)
WRITE1(7, dq)
#endif

// Numbers beyond the batch would read elsewhere.
uint permuted(uint b) { return min(perm[b], p.batch - 1); }

vec3 difference(uint b1, uint b3, uint k) {
  vec3 d;
  for (uint axis = 0; axis < 3; ++axis)
    d[axis] = load1(x1, (b1 * p.slots + k) * 3 + axis) - load1(x3, (b3 * p.slots + k) * 3 + axis);
  return d;
}

float norm(vec3 d) { return dot(abs(d), vec3(1)); }

// Of q min(norm, 1) by d.
vec3 slope(vec3 d, float weight) { return norm(d) <= 1.0 ? weight * sign(d) : vec3(0); }

void main() {
  uint i = flat_index();
  if (i >= p.batch * p.slots) return;
  uint b = i / p.slots;
  uint k = i % p.slots;
  vec3 d = difference(permuted(b), b, k);
  float distance = min(norm(d), 1.0);
#ifdef FORWARD
  terms[i] = load1(q, i) * distance;
#else
  float factor = p.scale * load1(dloss, 0);
  if ((p.wants & 1u) != 0) {
    vec3 sum = vec3(0);
    for (uint from = 0; from < p.batch; ++from)
      if (permuted(from) == b) sum += slope(difference(b, from, k), load1(q, from * p.slots + k));
    for (uint axis = 0; axis < 3; ++axis) add1(dx1, 3 * i + axis, factor * sum[axis], p.accumulates & 1u)
  }
  if ((p.wants & 2u) != 0) {
    vec3 g = slope(d, load1(q, i));
    for (uint axis = 0; axis < 3; ++axis) add1(dx3, 3 * i + axis, -factor * g[axis], p.accumulates & 2u)
  }
  if ((p.wants & 4u) != 0) add1(dq, i, factor * distance, p.accumulates & 4u)
#endif
}
