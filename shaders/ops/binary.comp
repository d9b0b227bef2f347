// variants: same same4 broadcast
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "flat4.glsl"
#ifdef SAME4
#define WIDE
#endif
#include "flat_any.glsl"
#include "row_store.glsl"
#include "unit_rows.glsl"

// y = a + b, a - b or a b. same: tensors of one shape and layout, one invocation takes 4 consecutive units.
// broadcast: row-major with strides, one word an invocation.
layout(constant_id = 1) const uint kKind = 0;  // enum BinaryKind

#ifdef BROADCAST
layout(push_constant) uniform Push {
  uint words;
  uint sizes[5];
  uint a_strides[5];  // 0 where a is repeated
  uint b_strides[5];
} p;
#else
layout(push_constant) uniform Push {
  uint units;
  uint accumulate;
  ROW_DIGITS
} p;
#endif

READ(0, a)
READ(1, b)
WRITE(2, y)
#ifndef BROADCAST
READ(3, old)  // y, for rows
#endif

VALUE combined(VALUE v, VALUE w) { return kKind == 0 ? v + w : kKind == 1 ? v - w : v * w; }

void main() {
#ifdef BROADCAST
  uint i = flat_index();
  if (i >= p.words) return;
  uint rest = i;
  uvec2 at = uvec2(0);
  for (int axis = 4; axis >= 0; --axis) {
    uint size = p.sizes[axis];
    at += rest % size * uvec2(p.a_strides[axis], p.b_strides[axis]);
    rest /= size;
  }
  y[i] = combined(load1(a, at.x), load1(b, at.y));
#else
#ifdef UNIT_ROWS
  if (kUnitRows) {
    ROWS(row, i, store4_row_below(y, int(p.units), row,
                                  combined(LOAD(a, i), LOAD(b, i)) + load4_or_zero(old, p.accumulate != 0, i)))
    return;
  }
#endif
  FOR4(i, flat_index() * 4, p.units, { ADD(y, i, combined(LOAD(a, i), LOAD(b, i)), p.accumulate) })
#endif
}
