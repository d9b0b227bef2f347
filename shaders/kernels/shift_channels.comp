#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// Of NC4HW4 tensors: to(n, c, y, x) (+)= from(n, c + shift, y, x), zero where `from` has no such channel.
// One invocation takes 4 consecutive vec4s of `to`.
layout(push_constant) uniform Push {
  uint vec4s;  // of `to`
  uint pixels;
  uint from_channels;
  uint to_channels;
  int shift;
  uint accumulate;
} p;

READ4(0, from)
WRITE4(1, to)

void main() {
  uint from_blocks = (p.from_channels + 3) / 4;
  uint to_blocks = (p.to_channels + 3) / 4;
  FOR4(i, flat_index() * 4, p.vec4s, {
    uint image = i / (to_blocks * p.pixels);
    uint block = i / p.pixels % to_blocks;
    vec4 v = vec4(0);
    for (uint lane = 0; lane < min(4u, p.to_channels - 4 * block); ++lane) {
      int c = int(4 * block + lane) + p.shift;
      if (c >= 0 && c < int(p.from_channels))
        v[lane] = load4(from, (image * from_blocks + uint(c) / 4) * p.pixels + i % p.pixels)[uint(c) % 4];
    }
    add4(to, i, v, p.accumulate)
  })
}
