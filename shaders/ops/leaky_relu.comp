// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// y = max(x, slope x); dx = dy where y > 0, slope dy elsewhere. One invocation takes 4 consecutive words.
layout(push_constant) uniform Push {
  uint words;
  float slope;
  uint accumulate;
} p;

#ifdef FORWARD
READ1(0, x)
WRITE1(1, y)
#else
READ1(0, y)
READ1(1, dy)
WRITE1(2, dx)
#endif

void main() {
  uint first = flat_index() * 4;
#ifdef FORWARD
  FOR4(i, first, p.words, { float v = load1(x, i); y[i] = v > 0.0 ? v : p.slope * v; })
#else
  FOR4(i, first, p.words, { add1(dx, i, (load1(y, i) > 0.0 ? 1.0 : p.slope) * load1(dy, i), p.accumulate) })
#endif
}
