// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#include "planes.glsl"

// Points (B, 3, H, W) = depth (B, 1, H, W) times the pixel's unit ray. One invocation takes 4 consecutive pixels.
layout(push_constant) uniform Push {
  uint count;  // B H W
  uint pixels;
  uint width;
  float centre_x;
  float centre_y;
  float inverse_focal;
  uint accumulate;
} p;

#ifdef FORWARD
READ1(0, depth)
WRITE1(1, points)
#else
READ1(0, dpoints)
WRITE1(1, ddepth)
#endif

vec3 ray(uint pixel) {
  float right = (float(pixel % p.width) - p.centre_x) * p.inverse_focal;
  float down = (float(pixel / p.width) - p.centre_y) * p.inverse_focal;
  return vec3(right, 1.0, -down) / sqrt(1.0 + right * right + down * down);
}

void take(uint i) {
  uint image = i / p.pixels;
  uint pixel = i - image * p.pixels;
  uint at = i + image * 2 * p.pixels;
#ifdef FORWARD
  store3(points, at, p.pixels, load1(depth, i) * ray(pixel))
#else
  add1(ddepth, i, dot(load3(dpoints, at, p.pixels), ray(pixel)), p.accumulate)
#endif
}

void main() {
  FOR4(i, flat_index() * 4, p.count, take(i);)
}
