// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = sum over objects of q |a - x|^2 / B; objects are (b, k), a and x (objects, numbers). da = 2 q (a - x) dloss / B = -dx,
// dq = |a - x|^2 dloss / B. One invocation takes one object.
layout(push_constant) uniform Push {
  uint objects;
  uint numbers;
  float scale;  // 1 / B
  uint wants;   // bit i of these speaks of input i
  uint accumulates;
} p;

READ1(0, a)
READ1(1, x)
READ1(2, q)
#ifdef FORWARD
WRITE1(3, terms)
#else
READ1(3, dloss)
WRITE1(4, da)
WRITE1(5, dx)
WRITE1(6, dq)
#endif

void main() {
  uint i = flat_index();
  if (i >= p.objects) return;
  uint begin = i * p.numbers;
  uint end = begin + p.numbers;
  float square = 0.0;
  for (uint n = begin; n < end; ++n) {
    float d = load1(a, n) - load1(x, n);
    square += d * d;
  }
#ifdef FORWARD
  terms[i] = load1(q, i) * square;
#else
  float factor = p.scale * load1(dloss, 0);
  float slope = 2.0 * factor * load1(q, i);
  for (uint n = begin; n < end; ++n) {
    float g = slope * (load1(a, n) - load1(x, n));
    if ((p.wants & 1u) != 0) add1(da, n, g, p.accumulates & 1u)
    if ((p.wants & 2u) != 0) add1(dx, n, -g, p.accumulates & 2u)
  }
  if ((p.wants & 4u) != 0) add1(dq, i, factor * square, p.accumulates & 4u)
#endif
}
