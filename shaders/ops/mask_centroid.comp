// variants: strips centroids pixels
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// c = sum of m P / s, s = sum of m + 1e-22; masks m (B, K + 1, H W), points P (B, 3, H W), centroids c (B, K, 3).
//   strips: one invocation sums (m P, m) over one strip of pixels of one object, in sums of 32
//   centroids: one invocation adds an object's strips to c, and to (c, s) for backward
//   pixels: dm = dc . (P - c) / s, 0 for background; dP = sum over k of dc m / s; one pixel an invocation
layout(push_constant) uniform Push {
  uint batch;
  uint slots;
  uint pixels;
  uint strip;
  uint strips;
  uint want_masks;
  uint want_points;
  uint accumulate_masks;
  uint accumulate_points;
} p;

#if defined(STRIPS)
READ1(0, masks)
READ1(1, points)
WRITE4(2, sums)
#elif defined(CENTROIDS)
READ4(0, sums)
WRITE4(1, weighed)
WRITE1(2, centroids)
#else
READ1(0, masks)
READ1(1, points)
READ4(2, weighed)
READ1(3, dcentroids)
WRITE1(4, dmasks)
WRITE1(5, dpoints)
#endif

#if !defined(CENTROIDS)
vec3 point_of(uint image, uint pixel) {
  uint at = image * 3 * p.pixels + pixel;
  return vec3(load1(points, at), load1(points, at + p.pixels), load1(points, at + 2 * p.pixels));
}
#endif

void main() {
  uint i = flat_index();
  uint objects = p.batch * p.slots;
#if defined(STRIPS)
  if (i >= objects * p.strips) return;
  uint object = i % objects;
  uint image = object / p.slots;
  uint mask = (image * (p.slots + 1) + object % p.slots) * p.pixels;
  uint begin = i / objects * p.strip;
  uint end = min(begin + p.strip, p.pixels);
  vec4 sum = vec4(0);
  for (uint first = begin; first < end; first += 32) {
    vec4 part = vec4(0);
    for (uint pixel = first; pixel < min(first + 32, end); ++pixel)
      part += load1(masks, mask + pixel) * vec4(point_of(image, pixel), 1);
    sum += part;
  }
  store4(sums, i, sum)
#elif defined(CENTROIDS)
  if (i >= objects) return;
  vec4 sum = vec4(0);
  for (uint s = 0; s < p.strips; ++s) sum += load4(sums, s * objects + i);
  float total = sum.w + 1e-22;
  vec3 c = sum.xyz / total;
  store4(weighed, i, vec4(c, total))
  for (uint axis = 0; axis < 3; ++axis) centroids[3 * i + axis] = c[axis];
#else
  if (i >= p.batch * p.pixels) return;
  uint image = i / p.pixels;
  uint pixel = i % p.pixels;
  vec3 point = point_of(image, pixel);
  vec3 dpoint = vec3(0);
  uint mask = image * (p.slots + 1) * p.pixels + pixel;
  for (uint k = 0; k < p.slots; ++k) {
    uint object = image * p.slots + k;
    vec4 c = load4(weighed, object);
    vec3 g = vec3(load1(dcentroids, 3 * object), load1(dcentroids, 3 * object + 1), load1(dcentroids, 3 * object + 2)) / c.w;
    dpoint += g * load1(masks, mask + k * p.pixels);
    if (p.want_masks != 0) add1(dmasks, mask + k * p.pixels, dot(g, point - c.xyz), p.accumulate_masks)
  }
  if (p.want_masks != 0) add1(dmasks, mask + p.slots * p.pixels, 0.0, p.accumulate_masks)
  if (p.want_points != 0)
    for (uint axis = 0; axis < 3; ++axis)
      add1(dpoints, (image * 3 + axis) * p.pixels + pixel, dpoint[axis], p.accumulate_points)
#endif
}
