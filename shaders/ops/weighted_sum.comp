#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// y = sum of weights[i] x_i over the first `count` inputs, in one invocation.
layout(push_constant) uniform Push {
  uint count;
  float weights[8];
} p;

READ1(0, x0)
READ1(1, x1)
READ1(2, x2)
READ1(3, x3)
READ1(4, x4)
READ1(5, x5)
READ1(6, x6)
READ1(7, x7)
WRITE1(8, y)

#define TERM(i, x) if (i < p.count) sum += p.weights[i] * load1(x, 0);

void main() {
  if (flat_index() != 0) return;
  float sum = 0.0;
  TERM(0, x0)
  TERM(1, x1)
  TERM(2, x2)
  TERM(3, x3)
  TERM(4, x4)
  TERM(5, x5)
  TERM(6, x6)
  TERM(7, x7)
  y[0] = sum;
}
