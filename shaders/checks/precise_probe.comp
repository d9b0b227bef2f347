#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"
#include "product_remainder.glsl"

// y = f(a, b), element by element, for the tests of precise.glsl and product_remainder.glsl.
layout(push_constant) uniform Push {
  uint count;
  uint function;
} p;

READ1(0, a)
READ1(1, b)
WRITE1(2, y)

float value(float u, float v) {
  switch (p.function) {
    case 0: return precise_exp(u);
    case 1: return precise_log(u);
    case 2: return precise_cos_sin(u).x;
    case 3: return precise_cos_sin(u).y;
    case 4: return precise_atan2(u, v);
    case 5: return precise_sigmoid(u);
    case 6: return cos_sin_of_step(uint(u), uint(v)).x;
    case 7: return cos_sin_of_step(uint(u), uint(v)).y;
    case 8: {
      precise float product = u * v;
      return product_remainder(u, v, product);
    }
  }
  return 0.0;
}

void main() {
  uint i = flat_index();
  if (i >= p.count) return;
  y[i] = value(load1(a, i), load1(b, i));
}
