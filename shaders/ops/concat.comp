#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"

// Channels of up to 6 NC4HW4 tensors one after another, where a block of 4 holds channels of several of them. Inputs that are absent
// have no channels. One invocation takes 4 consecutive vec4s of y.
layout(push_constant) uniform Push {
  uint vec4s;  // of y
  uint pixels;
  uint begins[7];  // channel of y at which each input begins, and the end
} p;

READ4(0, x0)
READ4(1, x1)
READ4(2, x2)
READ4(3, x3)
READ4(4, x4)
READ4(5, x5)
WRITE4(6, y)

// Where channel c of y lies in input k.
uint source(uint image, uint pixel, uint c, uint k) {
  uint blocks = (p.begins[k + 1] - p.begins[k] + 3) / 4;
  return (image * blocks + (c - p.begins[k]) / 4) * p.pixels + pixel;
}

#define FROM(x, k) load4(x, source(image, pixel, c, k))[(c - p.begins[k]) % 4]

void main() {
  uint channels = p.begins[6];
  uint blocks = (channels + 3) / 4;
  FOR4(i, flat_index() * 4, p.vec4s, {
    uint image = i / (blocks * p.pixels);
    uint block = i / p.pixels % blocks;
    uint pixel = i % p.pixels;
    vec4 v = vec4(0);
    for (uint lane = 0; lane < min(4u, channels - 4 * block); ++lane) {
      uint c = 4 * block + lane;
      if (c < p.begins[1]) v[lane] = FROM(x0, 0);
      else if (c < p.begins[2]) v[lane] = FROM(x1, 1);
      else if (c < p.begins[3]) v[lane] = FROM(x2, 2);
      else if (c < p.begins[4]) v[lane] = FROM(x3, 3);
      else if (c < p.begins[5]) v[lane] = FROM(x4, 4);
      else v[lane] = FROM(x5, 5);
    }
    store4(y, i, v)
  })
}
