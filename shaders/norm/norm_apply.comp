// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row_store.glsl"
#include "leaky.glsl"
#include "random.glsl"

// Forward:  y  = dropout((leaky(x) - mean) * scale + shift)
// Backward: dx = leaky'(x) * (dropout(dy) * scale - shift - (leaky(x) - mean) * slant)
// NC4HW4. table [group][block][4]: mean, scale, shift, slant; the last three are 0 in padding lanes.
// An invocation takes up to `each` pixels, `1 << lanes` apart, of channel block y of sample z; or kRows, which are stored by rows of a
// subgroup. What dx holds is then read as `old`, the same tensor.
layout(constant_id = 1) const uint kDropout = 0;
layout(constant_id = 2) const int kRows = 0;
layout(push_constant) uniform Push {
  uint pixels;
  uint strips;
  uint lanes;
  uint each;
  uint blocks;
  uint per_group;
  float slope;
  uint stream;
  uint threshold;
  float scale;
  uint accumulate;
  ROW_DIGITS
} p;
READU(0, random)
READ4(1, x)
READ4(2, table)
#ifdef FORWARD
WRITE4(3, y)
#else
READ4(3, dy)
WRITE4(4, dx)
READ4(5, old)
#endif

uvec2 key = uvec2(0);
vec4 mean, scale, shift, slant;

vec4 applied(uint at) {
  vec4 v = load4(x, at);
  vec4 centred = leaky(v, p.slope) - mean;
  vec4 mask = kDropout != 0 ? dropout4(key, at * 4, p.threshold, p.scale) : vec4(1);
#ifdef FORWARD
  return (centred * scale + shift) * mask;
#else
  return leaky_slope(v, p.slope) * (load4(dy, at) * mask * scale - shift - centred * slant);
#endif
}

void apply(uint at) {
#ifdef FORWARD
  store4(y, at, applied(at))
#else
  add4(dx, at, applied(at), p.accumulate)
#endif
}

void prepare(uint cb, uint n) {
  uint entry = (n / p.per_group * p.blocks + cb) * 4;
  mean = load4(table, entry);
  scale = load4(table, entry + 1);
  shift = load4(table, entry + 2);
#ifndef FORWARD
  slant = load4(table, entry + 3);
#endif
  if (kDropout != 0) key = random_key(random[0], random[1], p.stream);
}

#ifdef TEXEL
void apply_rows() {
  prepare(gl_WorkGroupID.y, gl_WorkGroupID.z);
  int pixels = int(p.pixels);
  int plane = (known_uniform6(int(gl_WorkGroupID.z)) * int(p.blocks) + known_uniform4(int(gl_WorkGroupID.y))) * pixels;
  int first = plane + known_uniform6(int(gl_WorkGroupID.x)) * kRows * int(gl_WorkGroupSize.x);
  [[unroll]] for (int k = 0; k < kRows; ++k) {
    int row = first + k * int(gl_WorkGroupSize.x);
    uint at = uint(row) + gl_LocalInvocationID.x;
#ifdef FORWARD
    store4_row_below(y, plane + pixels, row, applied(at))
#else
    store4_row_below(dx, plane + pixels, row, applied(at) + load4_or_zero(old, p.accumulate != 0, at))
#endif
  }
}
#endif

void main() {
#ifdef TEXEL
  if (kRows > 0) {
    apply_rows();
    return;
  }
#endif
  uint q = gl_GlobalInvocationID.x;
  uint first = (q >> p.lanes) * (p.each << p.lanes) + (q & ((1u << p.lanes) - 1));
  if (q >= p.strips || first >= p.pixels) return;
  uint cb = gl_WorkGroupID.y, n = gl_WorkGroupID.z;
  prepare(cb, n);
  uint plane = (n * p.blocks + cb) * p.pixels;
  uint count = min(p.each, ((p.pixels - 1 - first) >> p.lanes) + 1);
  uint at = plane + first, stride = 1u << p.lanes, k = 0;
  for (; k + 4 <= count; k += 4, at += 4 * stride) {
    apply(at);
    apply(at + stride);
    apply(at + 2 * stride);
    apply(at + 3 * stride);
  }
  for (; k < count; ++k, at += stride) apply(at);
}
