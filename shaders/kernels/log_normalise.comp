// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// Forward, in place: y minus the logarithm of its row's sum of exponentials. Backward: dy - exp(y) (sum of the row's dy).
// One invocation a row.
layout(push_constant) uniform Push {
  uint rows;
  uint width;
} p;

#ifdef FORWARD
WRITE1(0, y)
#else
READ1(0, y)
READ1(1, dy)
WRITE1(2, du)
#endif

void main() {
  uint row = flat_index();
  if (row >= p.rows) return;
  uint begin = row * p.width, end = begin + p.width;
  PreciseSum sum = PreciseSum(0.0, 0.0);
#ifdef FORWARD
  float largest = y[begin];
  for (uint i = begin + 1u; i < end; ++i) largest = max(largest, y[i]);
  for (uint i = begin; i < end; ++i) add_to(sum, precise_exp(y[i] - largest));
  float log_sum = precise_log(value_of(sum));
  for (uint i = begin; i < end; ++i) y[i] = (y[i] - largest) - log_sum;
#else
  for (uint i = begin; i < end; ++i) add_to(sum, load1(dy, i));
  float whole = value_of(sum);
  for (uint i = begin; i < end; ++i) du[i] = load1(dy, i) - precise_exp(load1(y, i)) * whole;
#endif
}
