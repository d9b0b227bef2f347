// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// loss = sum over objects of q |a - x|^2 / B; objects are (b, k), a and x (objects, 3). da = 2 q (a - x) dloss / B = -dx,
// dq = |a - x|^2 dloss / B. One invocation takes one object.
layout(push_constant) uniform Push {
  uint objects;
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
  vec3 d;
  for (uint axis = 0; axis < 3; ++axis) d[axis] = load1(a, 3 * i + axis) - load1(x, 3 * i + axis);
#ifdef FORWARD
  terms[i] = load1(q, i) * dot(d, d);
#else
  float factor = p.scale * load1(dloss, 0);
  vec3 g = 2.0 * factor * load1(q, i) * d;
  for (uint axis = 0; axis < 3; ++axis) {
    if ((p.wants & 1u) != 0) add1(da, 3 * i + axis, g[axis], p.accumulates & 1u)
    if ((p.wants & 2u) != 0) add1(dx, 3 * i + axis, -g[axis], p.accumulates & 2u)
  }
  if ((p.wants & 4u) != 0) add1(dq, i, factor * dot(d, d), p.accumulates & 4u)
#endif
}
