// variants: forward forward4 forward_channels backward backward4 backward_channels
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise4.glsl"
#if !defined(FORWARD) && !defined(BACKWARD)
#define WIDE
#endif
#include "flat_any.glsl"

// Along an axis of `size` entries: y = exp(x - m) / sum exp(x - m) with m the largest x, or x - m - log sum exp(x - m);
//   dx = y (dy - sum y dy), or dy - exp(y) sum dy.
// One invocation takes one row of words; in the variants with 4, of 4 neighbouring rows as vec4s; in those of channels, the channels
// of one pixel of NC4HW4, whose vec4s hold 4 neighbours of the same row.
layout(constant_id = 1) const bool kLog = false;

layout(push_constant) uniform Push {
  uint rows;
  uint size;
  uint inner;  // units between neighbours
  uint accumulate;
} p;

#if defined(FORWARD) || defined(FORWARD4) || defined(FORWARD_CHANNELS)
#define IS_FORWARD
READ(0, x)
WRITE(1, y)
#else
READ(0, y)
READ(1, dy)
WRITE(2, dx)
#endif

#if defined(FORWARD_CHANNELS) || defined(BACKWARD_CHANNELS)
#define TOTAL(v) dot(v, vec4(1))
#define LARGEST(v) max(max(v.x, v.y), max(v.z, v.w))
uint steps() { return (p.size + 3) / 4; }
bvec4 inside(uint k) { return lessThan(uvec4(0, 1, 2, 3) + 4 * k, uvec4(p.size)); }
#define PRESENT(v, k) mix(vec4(0), v, inside(k))
#define PRESENT_OR_LEAST(v, k) mix(vec4(-3.402823e38), v, inside(k))
#define ROW float
#else
#define TOTAL(v) (v)
#define LARGEST(v) (v)
uint steps() { return p.size; }
#define PRESENT(v, k) (v)
#define PRESENT_OR_LEAST(v, k) (v)
#define ROW VALUE
#endif

void main() {
  uint row = flat_index();
  if (row >= p.rows) return;
  uint first = row / p.inner * steps() * p.inner + row % p.inner;
#ifdef IS_FORWARD
  ROW largest = ROW(-3.402823e38);
  for (uint k = 0; k < steps(); ++k) {
    VALUE v = PRESENT_OR_LEAST(LOAD(x, first + k * p.inner), k);
    largest = max(largest, LARGEST(v));
  }
  ROW sum = ROW(0);
  for (uint k = 0; k < steps(); ++k) {
    VALUE v = precise_exp(LOAD(x, first + k * p.inner) - largest);
    sum += TOTAL(PRESENT(v, k));
  }
  ROW log_sum = kLog ? precise_log(sum) : ROW(0);
  ROW factor = 1.0 / sum;
  for (uint k = 0; k < steps(); ++k) {
    uint at = first + k * p.inner;
    VALUE v = LOAD(x, at) - largest;
    v = kLog ? v - log_sum : precise_exp(v) * factor;
    STORE(y, at, PRESENT(v, k))
  }
#else
  ROW sum = ROW(0);
  for (uint k = 0; k < steps(); ++k) {
    uint at = first + k * p.inner;
    VALUE v = LOAD(dy, at);
    if (!kLog) v *= LOAD(y, at);
    sum += TOTAL(PRESENT(v, k));
  }
  for (uint k = 0; k < steps(); ++k) {
    uint at = first + k * p.inner;
    VALUE out_ = LOAD(y, at);
    VALUE g = LOAD(dy, at);
    VALUE v = kLog ? g - precise_exp(out_) * sum : out_ * (g - sum);
    ADD(dx, at, PRESENT(v, k), p.accumulate)
  }
#endif
}
