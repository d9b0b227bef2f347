// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "precise.glsl"

// y = (image, log(depth + 1e-5)) mask, a vec4 for every hypothesis and pixel. One invocation takes one pixel of an image under
// all hypotheses.
layout(push_constant) uniform Push {
  uint count;  // B H W
  uint pixels;
  uint slots;  // S
  uint want_depth;
  uint want_masks;
  uint accumulate_depth;
  uint accumulate_masks;
} p;

READ1(0, image)
READ1(1, depth)
READ1(2, masks)
#ifdef FORWARD
WRITE4(3, y)
#else
READ4(3, dy)
WRITE1(4, ddepth)
WRITE1(5, dmasks)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint n = i / p.pixels;
  uint pixel = i - n * p.pixels;
  float d = load1(depth, i) + 1e-5;
  vec4 seen = vec4(load3(image, n * 3 * p.pixels + pixel, p.pixels), precise_log(d));
  uint at = n * p.slots * p.pixels + pixel;  // of masks, and of vec4s of y
#ifdef FORWARD
  for (uint s = 0; s < p.slots; ++s, at += p.pixels) store4(y, at, seen * load1(masks, at))
#else
  float sum = 0.0;
  for (uint s = 0; s < p.slots; ++s, at += p.pixels) {
    vec4 g = load4(dy, at);
    sum += g.w * load1(masks, at);
    if (p.want_masks != 0) add1(dmasks, at, dot(g, seen), p.accumulate_masks)
  }
  if (p.want_depth != 0) add1(ddepth, i, sum / d, p.accumulate_depth)
#endif
}
