// variants: forward score bins
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"
#include "pose_divergence.glsl"

// loss = -(1 / B) sum over (b, k) of q_bk min(D(p3[b, k], p1[perm b, k]), most); logarithms (B, K, bins), q (B, K).
//   forward   one invocation makes one (b, k)'s term
//   score     one invocation makes its D, before the minimum, and dq
//   bins      one invocation takes one bin: dlog_p3, and dlog_p1 from every b that perm sends to its scene
layout(push_constant) uniform Push {
  uint batch;
  uint slots;
  uint bins;
  float most;
  float scale;  // -1 / B
  uint wants;   // bit i of these speaks of input i
  uint accumulates;
} p;

READ1(0, log_p1)
READ1(1, log_p3)
READU(2, perm)
#if defined(FORWARD)
READ1(3, q)
WRITE1(4, terms)
#elif defined(SCORE)
READ1(3, dloss)
WRITE1(4, distances)
WRITE1(5, dq)
#else
READ1(3, q)
READ1(4, dloss)
READ1(5, distances)
WRITE1(6, dlog_p1)
WRITE1(7, dlog_p3)
#endif

// The object of another scene that object (b, k) is held against. Numbers beyond the batch would read elsewhere.
uint other(uint b, uint k) { return min(perm[b], p.batch - 1) * p.slots + k; }

#ifdef BINS
// d/du of q min(D, most), u = log_p3[object, n] or, with `first`, log_p1 of what it is held against.
float slope(uint b, uint k, uint n, bool first) {
  uint object = b * p.slots + k;
  if (load1(distances, object) > p.most) return 0.0;
  float u = load1(log_p3, object * p.bins + n);
  float v = load1(log_p1, other(b, k) * p.bins + n);
  return load1(q, object) * (first ? divergence_slope(v, u) : divergence_slope(u, v));
}
#else
float divergence(uint b, uint k) {
  uint at3 = (b * p.slots + k) * p.bins;
  uint at1 = other(b, k) * p.bins;
  float sum = 0.0;
  BIN_SUM(sum, p.bins, bin_divergence(load1(log_p3, at3 + n), load1(log_p1, at1 + n)))
  return sum;
}
#endif

void main() {
  uint i = flat_index();
#ifdef BINS
  uint object = i / p.bins;
  uint n = i - object * p.bins;
#else
  uint object = i;
#endif
  if (object >= p.batch * p.slots) return;
  uint b = object / p.slots;
  uint k = object - b * p.slots;
#if defined(FORWARD)
  terms[i] = load1(q, i) * min(divergence(b, k), p.most);
#elif defined(SCORE)
  float distance = divergence(b, k);
  distances[i] = distance;
  if ((p.wants & 4u) != 0) add1(dq, i, p.scale * load1(dloss, 0) * min(distance, p.most), p.accumulates & 4u)
#else
  float factor = p.scale * load1(dloss, 0);
  if ((p.wants & 1u) != 0) {
    float sum = 0.0;
    for (uint from = 0; from < p.batch; ++from)
      if (other(from, k) == object) sum += slope(from, k, n, true);
    add1(dlog_p1, i, factor * sum, p.accumulates & 1u)
  }
  if ((p.wants & 2u) != 0) add1(dlog_p3, i, factor * slope(b, k, n, false), p.accumulates & 2u)
#endif
}
