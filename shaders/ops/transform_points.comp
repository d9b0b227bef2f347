// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Forward: y = M (x, 1); backward: dx = the transposed 3 x 3 part of M times dy. One invocation a coordinate.
layout(push_constant) uniform Push {
  uint words;
  uint points;
  uint accumulate;
} p;

READ1(0, m)
READ1(1, x)
WRITE1(2, y)

void main() {
  uint i = flat_index();
  if (i >= p.words) return;
  uint point = i / 3u;
  uint axis = i - point * 3u;
  uint map = point / p.points * 16u;
#ifdef FORWARD
  uint first = map + axis * 4u;
  uint step_ = 1u;
  float value = load1(m, first + 3u);
#else
  uint first = map + axis;
  uint step_ = 4u;
  float value = 0.0;
#endif
  for (uint j = 0u; j < 3u; ++j) value += load1(m, first + j * step_) * load1(x, point * 3u + j);
  add1(y, i, value, p.accumulate)
}
