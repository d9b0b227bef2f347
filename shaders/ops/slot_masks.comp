// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"

// Softmax over K logits (K, B, H, W) and a 0, to masks (B, K+1, H, W). One invocation takes one pixel.
layout(push_constant) uniform Push {
  uint count;  // B H W
  uint pixels;
  uint slots;  // K
  uint accumulate;
} p;

#ifdef FORWARD
READ1(0, logits)
WRITE1(1, masks)
#else
READ1(0, masks)
READ1(1, dmasks)
WRITE1(2, dlogits)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint image = i / p.pixels;
  uint first = image * (p.slots + 1) * p.pixels + (i - image * p.pixels);
#ifdef FORWARD
  float most = 0.0;
  for (uint k = 0; k < p.slots; ++k) most = max(most, load1(logits, k * p.count + i));
  float sum = precise_exp(-most);
  for (uint k = 0; k < p.slots; ++k) sum += precise_exp(load1(logits, k * p.count + i) - most);
  float scale = 1.0 / sum;
  for (uint k = 0; k < p.slots; ++k) masks[first + k * p.pixels] = precise_exp(load1(logits, k * p.count + i) - most) * scale;
  masks[first + p.slots * p.pixels] = precise_exp(-most) * scale;
#else
  float mean = 0.0;
  for (uint k = 0; k <= p.slots; ++k) mean += load1(masks, first + k * p.pixels) * load1(dmasks, first + k * p.pixels);
  for (uint k = 0; k < p.slots; ++k) {
    uint at = first + k * p.pixels;
    add1(dlogits, k * p.count + i, load1(masks, at) * (load1(dmasks, at) - mean), p.accumulate)
  }
#endif
}
