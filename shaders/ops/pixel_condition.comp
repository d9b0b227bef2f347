// variants: forward strips sums points
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"

// y (B S, A + 4, H, W): channels are a hypothesis' A shared numbers, a pixel's point P, and 1. With A4 = ceil(A / 4):
//   forward   one invocation makes one vec4 of y
//   strips    one invocation sums dy over every strips-th pixel of one of a sample's first A4 vec4s
//   sums      one invocation adds the strips of one of them: up to 4 numbers of dshared
//   points    dP, summed over an image's hypotheses: one invocation takes one pixel
layout(push_constant) uniform Push {
  uint samples;  // B S
  uint slots;    // S
  uint shared_;  // A
  uint pixels;
  uint strips;
  uint accumulate;
} p;

#if defined(FORWARD)
READ1(0, numbers)
READ1(1, points)
WRITE4(2, y)

float channel(uint sample_, uint c, uint pixel) {
  if (c < p.shared_) return load1(numbers, sample_ * p.shared_ + c);
  uint axis = c - p.shared_;
  if (axis < 3u) return load1(points, (sample_ / p.slots * 3u + axis) * p.pixels + pixel);
  return axis == 3u ? 1.0 : 0.0;
}
#elif defined(STRIPS)
READ4(0, dy)
WRITE4(1, partial)
#elif defined(SUMS)
READ4(0, partial)
WRITE1(1, dnumbers)
#else
READ4(0, dy)
WRITE1(1, dpoints)
#endif

void main() {
  uint i = flat_index();
  uint blocks = (p.shared_ + 7u) / 4u;         // of a sample
  uint shared_blocks = (p.shared_ + 3u) / 4u;  // of these, those with shared numbers
#if defined(FORWARD)
  uint row = i / p.pixels;
  uint pixel = i - row * p.pixels;
  uint sample_ = row / blocks;
  if (sample_ >= p.samples) return;
  uint c = (row - sample_ * blocks) * 4u;
  store4(y, i, vec4(channel(sample_, c, pixel), channel(sample_, c + 1u, pixel), channel(sample_, c + 2u, pixel),
                    channel(sample_, c + 3u, pixel)))
#elif defined(STRIPS)
  uint row = i / p.strips;
  uint sample_ = row / shared_blocks;
  if (sample_ >= p.samples) return;
  uint plane = (sample_ * blocks + row - sample_ * shared_blocks) * p.pixels;
  vec4 sum = vec4(0);
  for (uint pixel = i - row * p.strips; pixel < p.pixels; pixel += p.strips) sum += load4(dy, plane + pixel);
  store4(partial, i, sum)
#elif defined(SUMS)
  uint sample_ = i / shared_blocks;
  if (sample_ >= p.samples) return;
  vec4 sum = vec4(0);
  for (uint strip = 0u; strip < p.strips; ++strip) sum += load4(partial, i * p.strips + strip);
  uint first = (i - sample_ * shared_blocks) * 4u;
  for (uint c = 0u; c < min(4u, p.shared_ - first); ++c)
    add1(dnumbers, sample_ * p.shared_ + first + c, sum[c], p.accumulate)
#else
  uint image = i / p.pixels;
  if (image * p.slots >= p.samples) return;
  uint pixel = i - image * p.pixels;
  vec3 sum = vec3(0);
  for (uint sample_ = image * p.slots; sample_ < (image + 1u) * p.slots; ++sample_)
    for (uint axis = 0u; axis < 3u; ++axis) {
      uint c = p.shared_ + axis;
      sum[axis] += load4(dy, (sample_ * blocks + c / 4u) * p.pixels + pixel)[c % 4u];
    }
  add3(dpoints, image * 3u * p.pixels + pixel, p.pixels, sum, p.accumulate)
#endif
}
