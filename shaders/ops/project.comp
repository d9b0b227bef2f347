// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#include "planes.glsl"

// Points (B, S, 3, H, W) to u, v and signed distance. One invocation takes 4 consecutive pixels.
layout(push_constant) uniform Push {
  uint count;  // B S H W
  uint pixels;
  float focal;
  uint accumulate;
} p;

READ1(0, points)
#ifdef FORWARD
WRITE1(1, uvd)
#else
READ1(1, duvd)
WRITE1(2, dpoints)
#endif

const float kTiny = 1e-5;

void take(uint i) {
  uint at = i + i / p.pixels * 2 * p.pixels;
  vec3 point = load3(points, at, p.pixels);
  float inverse = 1.0 / (abs(point.y) + kTiny);
  float scale = p.focal * inverse;
  float side = sign(point.y + kTiny);
  float norm = sqrt(dot(point, point));
#ifdef FORWARD
  store3(uvd, at, p.pixels, vec3(point.x * scale, -point.z * scale, norm * side))
#else
  vec3 g = load3(duvd, at, p.pixels);
  vec3 d = norm > 0.0 ? point * (g.z * side / norm) : vec3(0);
  d.x += g.x * scale;
  d.y += (g.y * point.z - g.x * point.x) * scale * inverse * sign(point.y);
  d.z -= g.y * scale;
  add3(dpoints, at, p.pixels, d, p.accumulate)
#endif
}

void main() {
  FOR4(i, flat_index() * 4, p.count, take(i);)
}
