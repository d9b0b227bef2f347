// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = (1 / B) sum of (m - m')^2 over all pairs of pixels beside or above each other; masks (planes, H, W). Forward: one invocation
// makes one row's term, of the pairs within it and with the row below. Backward: one pixel's gradient, from its four neighbours.
layout(push_constant) uniform Push {
  uint count;
  uint height;
  uint width;
  float scale;  // backward: 2 / B
  uint accumulate;
} p;

READ1(0, m)
#ifdef FORWARD
WRITE1(1, terms)
#else
READ1(1, dloss)
WRITE1(2, dm)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
#ifdef FORWARD
  bool below = i % p.height + 1 < p.height;
  float sum = 0.0;
  for (uint first = 0; first < p.width; first += 32) {
    float part = 0.0;
    for (uint column = first; column < min(first + 32, p.width); ++column) {
      uint at = i * p.width + column;
      float here = load1(m, at);
      float across = column + 1 < p.width ? here - load1(m, at + 1) : 0.0;
      float down = below ? here - load1(m, at + p.width) : 0.0;
      part += across * across + down * down;
    }
    sum += part;
  }
  terms[i] = sum;
#else
  uint row = i / p.width;
  uint column = i - row * p.width;
  row %= p.height;
  float here = load1(m, i);
  float sum = 0.0;
  if (column > 0) sum += here - load1(m, i - 1);
  if (column + 1 < p.width) sum += here - load1(m, i + 1);
  if (row > 0) sum += here - load1(m, i - p.width);
  if (row + 1 < p.height) sum += here - load1(m, i + p.width);
  add1(dm, i, p.scale * load1(dloss, 0) * sum, p.accumulate)
#endif
}
