// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// 0.99 clip(total, 0, 1). One invocation takes 4 consecutive words.
layout(push_constant) uniform Push {
  uint words;
  uint accumulate;
} p;

READ1(0, total)
#ifdef FORWARD
WRITE1(1, share)
#else
READ1(1, dshare)
WRITE1(2, dtotal)
#endif

const float kMost = 0.99;

void main() {
#ifdef FORWARD
  FOR4(i, flat_index() * 4, p.words, share[i] = kMost * clamp(load1(total, i), 0.0, 1.0);)
#else
  FOR4(i, flat_index() * 4, p.words, {
    float t = load1(total, i);
    add1(dtotal, i, t >= 0.0 && t <= 1.0 ? kMost * load1(dshare, i) : 0.0, p.accumulate)
  })
#endif
}
