// variants: location pose shares d_weights d_location d_pose
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// What is known of a's objects l in the order of b's objects k, by log w_kl. One invocation an element of what is written, except
// `shares`: one for each (k, bin).
//
// location    X_k = sum over l of w_kl X_l
// pose        u_km = logsumexp over l of (log w_kl + log p_lm); its normalisation follows elsewhere
// shares      t_klm = du_km w_kl p_lm / exp(u_km): both log w_kl and log p_lm receive it
// d_weights   sum over m of t_klm, plus w_kl (dX_k . X_l)
// d_location  sum over k of w_kl dX_k
// d_pose      sum over k of t_klm
layout(constant_id = 1) const uint kSlots = 1;  // of pose and shares only
layout(push_constant) uniform Push {
  uint count;
  uint slots;
  uint width;
  uint accumulate;
} p;

#ifndef D_POSE
READ1(0, log_w)
float weight(uint k, uint l) { return precise_exp(load1(log_w, k * p.slots + l)); }
#endif

#if defined(LOCATION)
READ1(1, x)
WRITE1(2, y)
#elif defined(POSE)
READ1(1, log_p)
WRITE1(2, y)
#elif defined(SHARES)
READ1(1, log_p)
READ1(2, du)
WRITE1(3, y)
#elif defined(D_WEIGHTS)
READ1(1, x)
READ1(2, dx)
READ1(3, shares)
WRITE1(4, y)
#elif defined(D_LOCATION)
READ1(1, dx)
WRITE1(2, y)
#else
READ1(0, shares)
WRITE1(1, y)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
#ifdef D_WEIGHTS
  // y is (B, K, K): `row` counts b's objects of the whole batch, `other` a's within the entry.
  uint row = i / p.slots;
  uint other = i - row * p.slots;
#else
  uint row = i / p.width;
  uint m = i - row * p.width;
#endif
  uint entry = row / p.slots * p.slots;  // its first row
  uint slot = row - entry;

#if defined(LOCATION)
  float sum = 0.0;
  for (uint l = 0u; l < p.slots; ++l) sum += weight(row, l) * load1(x, (entry + l) * 3u + m);
  y[i] = sum;

#elif defined(POSE) || defined(SHARES)
  float term[kSlots];
  float largest = uintBitsToFloat(0xff800000u);
  for (uint l = 0u; l < kSlots; ++l) {
    term[l] = load1(log_w, row * kSlots + l) + load1(log_p, (entry + l) * p.width + m);
    largest = max(largest, term[l]);
  }
  float sum = 0.0;
  for (uint l = 0u; l < kSlots; ++l) {
    term[l] = precise_exp(term[l] - largest);
    sum += term[l];
  }
#ifdef POSE
  y[i] = largest + precise_log(sum);
#else
  float scale = load1(du, i) / sum;
  for (uint l = 0u; l < kSlots; ++l) y[(row * kSlots + l) * p.width + m] = scale * term[l];
#endif

#elif defined(D_WEIGHTS)
  float dot_ = 0.0;
  for (uint c = 0u; c < 3u; ++c) dot_ += load1(dx, row * 3u + c) * load1(x, (entry + other) * 3u + c);
  PreciseSum sum = PreciseSum(weight(row, other) * dot_, 0.0);
  for (uint n = 0u; n < p.width; ++n) add_to(sum, load1(shares, i * p.width + n));
  add1(y, i, value_of(sum), p.accumulate)

#elif defined(D_LOCATION)
  float sum = 0.0;
  for (uint k = 0u; k < p.slots; ++k) sum += weight(entry + k, slot) * load1(dx, (entry + k) * 3u + m);
  add1(y, i, sum, p.accumulate)

#else
  float sum = 0.0;
  for (uint k = 0u; k < p.slots; ++k) sum += load1(shares, ((entry + k) * p.slots + slot) * p.width + m);
  add1(y, i, sum, p.accumulate)
#endif
}
