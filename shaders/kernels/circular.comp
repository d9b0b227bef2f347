// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// Sums around a circle of bins, one invocation an element of the result. Indices are modulo the bins.
// forward:   y[o] = logsumexp over i of own[i] + other[own_step o + step i]
// backward:  d_own[o] = sum over t of dy[t] exp(own[o] + other[own_step o + step t] - y[t])
layout(push_constant) uniform Push {
  uint count;
  uint bins;
  uint own_step;
  uint step_;
  uint accumulate;
} p;

READ1(0, own)
READ1(1, other)
#ifdef FORWARD
WRITE1(2, y)
#else
READ1(2, y)
READ1(3, dy)
WRITE1(4, d_own)
#endif

void advance(inout uint index) {
  index += p.step_;
  if (index >= p.bins) index -= p.bins;
}

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint row = i / p.bins * p.bins;
  uint o = i - row;
  uint start = o * p.own_step % p.bins;
  uint at = start;
#ifdef FORWARD
  float largest = uintBitsToFloat(0xff800000u);
  for (uint t = 0u; t < p.bins; ++t, advance(at))
    largest = max(largest, load1(own, row + t) + load1(other, row + at));
  PreciseSum sum = PreciseSum(0.0, 0.0);
  at = start;
  for (uint t = 0u; t < p.bins; ++t, advance(at))
    add_to(sum, precise_exp(load1(own, row + t) + load1(other, row + at) - largest));
  y[i] = largest + precise_log(value_of(sum));
#else
  float here = load1(own, i);
  PreciseSum sum = PreciseSum(0.0, 0.0);
  for (uint t = 0u; t < p.bins; ++t, advance(at))
    add_to(sum, load1(dy, row + t) * precise_exp(here + load1(other, row + at) - load1(y, row + t)));
  add1(d_own, i, value_of(sum), p.accumulate)
#endif
}
