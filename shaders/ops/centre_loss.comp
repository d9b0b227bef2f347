// variants: strips centres location pixels
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = mean over B, K, 3 of (c - X)^2 with c = sum of m P / s, s = sum of m + 1e-22; masks m (B, K + 1, H W), points P (B, 3, H W),
// location X (B, K, 3).
//   strips: one invocation sums (m P, m) over one strip of pixels of one object, in sums of 32
//   centres: one invocation adds an object's strips to (c, s) and writes its term, the sum over 3
// With g = 2 / (3 B K) (c - X) dloss:
//   location: dX = -g, one word an invocation
//   pixels: dm = g . (P - c) / s, 0 for background; dP = sum over k of g m / s; one pixel an invocation
layout(push_constant) uniform Push {
  uint batch;
  uint slots;
  uint pixels;
  uint strip;
  uint strips;
  float scale;  // 2 / (3 B K)
  uint want_masks;
  uint want_points;
  uint accumulate_masks;
  uint accumulate_points;
  uint accumulate_location;
} p;

#if defined(STRIPS)
READ1(0, masks)
READ1(1, points)
WRITE4(2, sums)
#elif defined(CENTRES)
READ4(0, sums)
READ1(1, location)
WRITE4(2, centres)
WRITE1(3, terms)
#elif defined(LOCATION)
READ4(0, centres)
READ1(1, location)
READ1(2, dloss)
WRITE1(3, dlocation)
#else
READ1(0, masks)
READ1(1, points)
READ4(2, centres)
READ1(3, location)
READ1(4, dloss)
WRITE1(5, dmasks)
WRITE1(6, dpoints)
#endif

#if defined(STRIPS) || defined(PIXELS)
vec3 point_of(uint image, uint pixel) {
  uint at = image * 3 * p.pixels + pixel;
  return vec3(load1(points, at), load1(points, at + p.pixels), load1(points, at + 2 * p.pixels));
}
#endif
#if defined(CENTRES) || defined(PIXELS)
vec3 location_of(uint object) {
  return vec3(load1(location, 3 * object), load1(location, 3 * object + 1), load1(location, 3 * object + 2));
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
#elif defined(CENTRES)
  if (i >= objects) return;
  vec4 sum = vec4(0);
  for (uint s = 0; s < p.strips; ++s) sum += load4(sums, s * objects + i);
  float total = sum.w + 1e-22;
  vec3 centre = sum.xyz / total;
  vec3 d = centre - location_of(i);
  store4(centres, i, vec4(centre, total))
  terms[i] = dot(d, d);
#elif defined(LOCATION)
  if (i >= 3 * objects) return;
  float d = load4(centres, i / 3)[i % 3] - load1(location, i);
  add1(dlocation, i, -p.scale * load1(dloss, 0) * d, p.accumulate_location)
#else
  if (i >= p.batch * p.pixels) return;
  uint image = i / p.pixels;
  uint pixel = i % p.pixels;
  vec3 point = point_of(image, pixel);
  vec3 dpoint = vec3(0);
  uint mask = image * (p.slots + 1) * p.pixels + pixel;
  float factor = p.scale * load1(dloss, 0);
  for (uint k = 0; k < p.slots; ++k) {
    uint object = image * p.slots + k;
    vec4 centre = load4(centres, object);
    vec3 g = factor * (centre.xyz - location_of(object)) / centre.w;
    dpoint += g * load1(masks, mask + k * p.pixels);
    if (p.want_masks != 0) add1(dmasks, mask + k * p.pixels, dot(g, point - centre.xyz), p.accumulate_masks)
  }
  if (p.want_masks != 0) add1(dmasks, mask + p.slots * p.pixels, 0.0, p.accumulate_masks)
  if (p.want_points != 0)
    for (uint axis = 0; axis < 3; ++axis)
      add1(dpoints, (image * 3 + axis) * p.pixels + pixel, dpoint[axis], p.accumulate_points)
#endif
}
