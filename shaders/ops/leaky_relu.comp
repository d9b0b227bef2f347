// variants: forward forward4 backward backward4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "flat4.glsl"
#include "leaky.glsl"
#if defined(FORWARD4) || defined(BACKWARD4)
#define WIDE
#endif
#include "flat_any.glsl"
#include "row_store.glsl"
#include "unit_rows.glsl"

// y = max(x, slope x); dx = dy where y > 0, slope dy elsewhere. One invocation takes 4 consecutive units.
layout(push_constant) uniform Push {
  uint units;
  float slope;
  uint accumulate;
  ROW_DIGITS
} p;

#if defined(FORWARD) || defined(FORWARD4)
READ(0, x)
WRITE(1, y)
#else
READ(0, y)
READ(1, dy)
WRITE(2, dx)
READ(3, old)  // dx, for rows
#endif

#if defined(FORWARD) || defined(FORWARD4)
VALUE made(uint i) {
  VALUE v = LOAD(x, i);
  return v * leaky_slope(v, p.slope);
}
#else
VALUE made(uint i) { return leaky_slope(LOAD(y, i), p.slope) * LOAD(dy, i); }
#endif

void main() {
#ifdef UNIT_ROWS
  if (kUnitRows) {
#ifdef FORWARD4
    ROWS(row, i, store4_row_below(y, int(p.units), row, made(i)))
#else
    ROWS(row, i, store4_row_below(dx, int(p.units), row, made(i) + load4_or_zero(old, p.accumulate != 0, i)))
#endif
    return;
  }
#endif
  uint first = flat_index() * 4;
#if defined(FORWARD) || defined(FORWARD4)
  FOR4(i, first, p.units, { STORE(y, i, made(i)) })
#else
  FOR4(i, first, p.units, { ADD(dx, i, made(i), p.accumulate) })
#endif
}
