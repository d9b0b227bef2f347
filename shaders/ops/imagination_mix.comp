// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "precise4.glsl"

// Mean over the hypotheses of (colour, depth) = (1, 1, 1, max_depth) sigmoid(y 0-3) + (0, 0, 0, 1e-5), weighted by softmax(y 4).
// Every pixel of a hypothesis has two vec4s: y 0-3, and a plane later (y 4, padding). One invocation takes one pixel of an image.
layout(push_constant) uniform Push {
  uint count;  // B H W
  uint pixels;
  uint slots;
  float max_depth;
  uint accumulate;
} p;

READ4(0, y)
#ifdef FORWARD
WRITE1(1, image)
WRITE1(2, depth)
#else
READ1(1, image)
READ1(2, depth)
READ1(3, dimage)
READ1(4, ddepth)
WRITE4(5, dy)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  uint n = i / p.pixels;
  uint pixel = i - n * p.pixels;
  uint first = n * p.slots * 2 * p.pixels + pixel;
  uint colour = n * 3 * p.pixels + pixel;
  vec4 scale = vec4(1, 1, 1, p.max_depth);

  float most = load4(y, first + p.pixels).x;
  for (uint s = 1; s < p.slots; ++s) most = max(most, load4(y, first + (2 * s + 1) * p.pixels).x);
  float sum = 0.0;
#ifdef FORWARD
  vec4 mean = vec4(0);
  for (uint s = 0; s < p.slots; ++s) {
    uint at = first + 2 * s * p.pixels;
    float weight = precise_exp(load4(y, at + p.pixels).x - most);
    sum += weight;
    mean += weight * precise_sigmoid(load4(y, at));
  }
  mean = scale * mean / sum;
  store3(image, colour, p.pixels, mean.xyz)
  depth[i] = mean.w + 1e-5;
#else
  for (uint s = 0; s < p.slots; ++s) sum += precise_exp(load4(y, first + (2 * s + 1) * p.pixels).x - most);
  vec4 mean = vec4(load3(image, colour, p.pixels), load1(depth, i) - 1e-5);
  vec4 g = vec4(load3(dimage, colour, p.pixels), load1(ddepth, i));
  for (uint s = 0; s < p.slots; ++s) {
    uint at = first + 2 * s * p.pixels;
    float weight = precise_exp(load4(y, at + p.pixels).x - most) / sum;
    vec4 value = precise_sigmoid(load4(y, at));
    add4(dy, at, weight * g * scale * value * (1.0 - value), p.accumulate)
    add4(dy, at + p.pixels, vec4(weight * dot(g, scale * value - mean), 0, 0, 0), p.accumulate)
  }
#endif
}
