// variants: words vec4s
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// y = x, wrong on purpose, for the tests of guard bands: one invocation also writes element p.stray of y, and every one reads the
// element p.ahead further in x, which adds nothing while it is a number.
layout(push_constant) uniform Push {
  uint count;
  int stray;
  int ahead;
  float zero;
  uint accumulate;
} p;

#ifdef VEC4S
READ4(0, x)
WRITE4(1, y)
#define value(i) (load4(x, i) + p.zero * load4(x, i + p.ahead))
#define put(i, v) add4(y, i, v, p.accumulate)
#else
READ1(0, x)
WRITE1(1, y)
#define value(i) (load1(x, i) + p.zero * load1(x, i + p.ahead))
#define put(i, v) add1(y, i, v, p.accumulate)
#endif

void main() {
  int i = int(flat_index());
  if (uint(i) >= p.count) return;
  put(i, value(i))
  if (i == 0 && p.stray != 0) put(p.stray, value(i))
}
