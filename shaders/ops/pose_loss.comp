// variants: forward bins score
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// loss = sum over objects of q D(a, r) / B; objects are (b, k), log_a and log_r (objects, bins). With d = log_a - log_r:
//   symmetric KL: D = 1/2 sum (a - r) d;  dD/dlog_a = 1/2 (a d + a - r),  dD/dlog_r = -1/2 (r d + a - r)
//   Jensen-Shannon, m = (a + r) / 2: D = 1/2 sum a log(a / m) + r log(r / m);  dD/dlog_a = 1/2 a log(a / m), the same for r,
//     because a log m + r log m = 2 m log m changes with a by log m + 1, and the 1 cancels that of a log a.
// forward: one invocation makes one object's term. bins: one bin's gradients. score: one object's dq.
layout(constant_id = 1) const uint kDivergence = 0;  // enum PoseDivergence

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

// log(a / m) from d = log a - log r: -log((1 + exp(-d)) / 2), written so that exp does not overflow.
float log_over_mean(float d) { return 0.69314718 - max(-d, 0.0) - precise_log(1.0 + precise_exp(-abs(d))); }

float bin_divergence(float u, float v) {
  float d = u - v;
  if (kDivergence == 0) return 0.5 * (precise_exp(u) - precise_exp(v)) * d;
  return 0.5 * (precise_exp(u) * log_over_mean(d) + precise_exp(v) * log_over_mean(-d));
}

float divergence(uint object) {
  float sum = 0.0;
  for (uint first = 0; first < p.bins; first += 32) {
    float part = 0.0;
    for (uint n = first; n < min(first + 32, p.bins); ++n)
      part += bin_divergence(load1(log_a, object * p.bins + n), load1(log_r, object * p.bins + n));
    sum += part;
  }
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
  float a = precise_exp(u);
  float r = precise_exp(v);
  float factor = 0.5 * p.scale * load1(dloss, 0) * load1(q, i / p.bins);
  float ga = kDivergence == 0 ? a * (u - v) + (a - r) : a * log_over_mean(u - v);
  float gr = kDivergence == 0 ? -r * (u - v) - (a - r) : r * log_over_mean(v - u);
  if ((p.wants & 1u) != 0) add1(dlog_a, i, factor * ga, p.accumulates & 1u)
  if ((p.wants & 2u) != 0) add1(dlog_r, i, factor * gr, p.accumulates & 2u)
#else
  if (i >= p.objects) return;
  add1(dq, i, p.scale * load1(dloss, 0) * divergence(i), p.accumulates & 4u)
#endif
}
