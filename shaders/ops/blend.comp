// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// y = share a + (1 - share) b. One invocation takes one pixel's channels.
layout(push_constant) uniform Push {
  uint count;  // B H W
  uint pixels;
  uint channels;
  uint want_share;
  uint want_a;
  uint want_b;
  uint accumulate_share;
  uint accumulate_a;
  uint accumulate_b;
} p;

READ1(0, share)
READ1(1, a)
READ1(2, b)
#ifdef FORWARD
WRITE1(3, y)
#else
READ1(3, dy)
WRITE1(4, dshare)
WRITE1(5, da)
WRITE1(6, db)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  float s = load1(share, i);
  uint image = i / p.pixels;
  uint at = image * p.channels * p.pixels + (i - image * p.pixels);
#ifdef FORWARD
  for (uint c = 0; c < p.channels; ++c, at += p.pixels) y[at] = s * load1(a, at) + (1.0 - s) * load1(b, at);
#else
  float sum = 0.0;
  for (uint c = 0; c < p.channels; ++c, at += p.pixels) {
    float g = load1(dy, at);
    sum += g * (load1(a, at) - load1(b, at));
    if (p.want_a != 0) add1(da, at, s * g, p.accumulate_a)
    if (p.want_b != 0) add1(db, at, (1.0 - s) * g, p.accumulate_b)
  }
  if (p.want_share != 0) add1(dshare, i, sum, p.accumulate_share)
#endif
}
