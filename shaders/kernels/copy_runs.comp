// variants: words vec4s
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "flat4.glsl"
#ifdef VEC4S
#define WIDE
#endif
#include "flat_any.glsl"
#include "row_store.glsl"
#include "unit_rows.glsl"

// to[o to_stride + to_begin + r] (+)= from[o from_stride + from_begin + r] for r < run; sizes in units, that is words or vec4s.
// One invocation takes 4 consecutive units, or a workgroup rows that lie in one run (unit_rows.glsl).
layout(push_constant) uniform Push {
  uint units;
  uint run;
  uint from_stride;
  uint from_begin;
  uint to_stride;
  uint to_begin;
  uint accumulate;
  ROW_DIGITS
} p;

READ(0, from)
WRITE(1, to)
READ(2, old)  // `to`, for rows

void main() {
#ifdef UNIT_ROWS
  if (kUnitRows) {
    int lane = int(gl_LocalInvocationID.x);
    int first = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * kRowsOfGroup * int(gl_WorkGroupSize.x);
    int o = first / int(p.run);
    int r = first - o * int(p.run);
    int from_at = o * int(p.from_stride) + int(p.from_begin) + r + lane;
    int to_at = known_uniform6(o) * int(p.to_stride) + int(p.to_begin) + known_uniform8(r);
    [[unroll]] for (int k = 0; k < kRowsOfGroup; ++k) {
      int on = k * int(gl_WorkGroupSize.x);
      vec4 v = load4(from, from_at + on);
      store4_row(to, known_uniform6(o) * int(p.run) < int(p.units), to_at + on, v + load4_or_zero(old, p.accumulate != 0, to_at + on + lane))
    }
    return;
  }
#endif
  FOR4(i, flat_index() * 4, p.units, {
    uint o = i / p.run;
    uint r = i - o * p.run;
    ADD(to, o * p.to_stride + p.to_begin + r, LOAD(from, o * p.from_stride + p.from_begin + r), p.accumulate)
  })
}
