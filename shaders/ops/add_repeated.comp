// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// a and y (F, K, run), b (F, run): y = a + b with b repeated over K; db = sum over K of dy, in order.
// One invocation takes one vec4 of b and the K of a.
layout(push_constant) uniform Push {
  uint vec4s;  // of b
  uint run;
  uint repeats;
  uint accumulate;
} p;

#ifdef FORWARD
READ4(0, a)
READ4(1, b)
WRITE4(2, y)
#else
READ4(0, dy)
WRITE4(1, db)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.vec4s) return;
  uint frame = i / p.run;
  uint first = frame * p.repeats * p.run + i % p.run;
#ifdef FORWARD
  vec4 v = load4(b, i);
  for (uint k = 0; k < p.repeats; ++k) {
    uint at = first + k * p.run;
    store4(y, at, load4(a, at) + v)
  }
#else
  vec4 sum = vec4(0);
  for (uint k = 0; k < p.repeats; ++k) sum += load4(dy, first + k * p.run);
  add4(db, i, sum, p.accumulate)
#endif
}
