// variants: pack pack4 unpack unpack4
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Between row-major (N, C, P) and NC4HW4 [n][c / 4][p], P pixels. pack makes NC4HW4, unpack row-major; one invocation takes one vec4
// of NC4HW4, or in pack4 and unpack4 those of 4 consecutive pixels (P a multiple of 4).
layout(push_constant) uniform Push {
  uint units;  // invocations
  uint pixels;
  uint channels;
  uint accumulate;
} p;

#if defined(PACK)
READ1(0, from)
WRITE4(1, to)
#elif defined(PACK4)
READ4(0, from)
WRITE4(1, to)
#elif defined(UNPACK)
READ4(0, from)
WRITE1(1, to)
#else
READ4(0, from)
WRITE4(1, to)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.units) return;
#if defined(PACK) || defined(UNPACK)
  uint steps = p.pixels;
#else
  uint steps = p.pixels / 4;
#endif
  uint blocks = (p.channels + 3) / 4;
  uint plane = i / steps;  // n blocks + block
  uint block = plane % blocks;
  uint lanes = min(4u, p.channels - 4 * block);
  uint row = (plane / blocks * p.channels + 4 * block) * steps + i % steps;  // of the block's first channel
#if defined(PACK)
  vec4 v = vec4(0);
  for (uint lane = 0; lane < lanes; ++lane) v[lane] = load1(from, row + lane * steps);
  add4(to, i, v, p.accumulate)
#elif defined(UNPACK)
  vec4 v = load4(from, i);
  for (uint lane = 0; lane < lanes; ++lane) add1(to, row + lane * steps, v[lane], p.accumulate)
#elif defined(PACK4)
  mat4 m = mat4(0);
  for (uint lane = 0; lane < lanes; ++lane) m[lane] = load4(from, row + lane * steps);
  m = transpose(m);
  for (uint k = 0; k < 4; ++k) add4(to, 4 * i + k, m[k], p.accumulate)
#else
  mat4 m = mat4(0);
  for (uint k = 0; k < 4; ++k) m[k] = load4(from, 4 * i + k);
  m = transpose(m);
  for (uint lane = 0; lane < lanes; ++lane) add4(to, row + lane * steps, m[lane], p.accumulate)
#endif
}
