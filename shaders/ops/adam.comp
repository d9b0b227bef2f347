#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// One Adam step on flat tensors, in place; the formula is in graph/ops/adam.h. One invocation takes 4 consecutive numbers.
layout(push_constant) uniform Push {
  uint count;
  float learning_rate;
  float beta1;
  float beta2;
  float epsilon;
  float clip;
} p;

WRITE1(0, parameters)
READ1(1, gradient)
WRITE1(2, first)
WRITE1(3, second)
READ1(4, correction)

void main() {
  uint begin = flat_index() * 4u;
  float step = p.learning_rate / load1(correction, 0);
  float root = sqrt(load1(correction, 1));
  for (uint i = begin; i < min(begin + 4u, p.count); ++i) {
    float g = clamp(load1(gradient, i), -p.clip, p.clip);
    float m = p.beta1 * first[i] + (1.0 - p.beta1) * g;
    float v = p.beta2 * second[i] + (1.0 - p.beta2) * g * g;
    first[i] = m;
    second[i] = v;
    parameters[i] -= step * m / (sqrt(v) / root + p.epsilon);
  }
}
