// variants: forward bins score
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"
#include "pose_divergence.glsl"

// loss = sum over objects of q D(a, r) / B; objects are (b, k), log_a and log_r (objects, bins).
// forward: one invocation makes one object's term. bins: one bin's gradients. score: one object's dq.
layout(push_constant) uniform Push {
  uint objects;
  uint bins;
  float scale;  // 1 / B
  uint wants;   // bit i of these speaks of input i
  uint accumulates;
} p;

READ1(0, log_a)
READ1(1, log_r)
#if defined(FORWARD)
READ1(2, q)
WRITE1(3, terms)
#elif defined(BINS)
READ1(2, q)
READ1(3, dloss)
WRITE1(4, dlog_a)
WRITE1(5, dlog_r)
#else
READ1(2, dloss)
WRITE1(3, dq)
#endif

float divergence(uint object) {
  float sum = 0.0;
  BIN_SUM(sum, p.bins, bin_divergence(load1(log_a, object * p.bins + n), load1(log_r, object * p.bins + n)))
  return sum;
}

void main() {
  uint i = flat_index();
#if defined(FORWARD)
  if (i >= p.objects) return;
  terms[i] = load1(q, i) * divergence(i);
#elif defined(BINS)
  if (i >= p.objects * p.bins) return;
  float u = load1(log_a, i);
  float v = load1(log_r, i);
  float factor = p.scale * load1(dloss, 0) * load1(q, i / p.bins);
  if ((p.wants & 1u) != 0) add1(dlog_a, i, factor * divergence_slope(u, v), p.accumulates & 1u)
  if ((p.wants & 2u) != 0) add1(dlog_r, i, factor * divergence_slope(v, u), p.accumulates & 2u)
#else
  if (i >= p.objects) return;
  add1(dq, i, p.scale * load1(dloss, 0) * divergence(i), p.accumulates & 4u)
#endif
}
