#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// c ← β c + (1 − β) for both moments: afterwards c = 1 − βᵗ of this step. One invocation.
layout(push_constant) uniform Push {
  float beta1;
  float beta2;
} p;

WRITE1(0, correction)

void main() {
  correction[0] = p.beta1 * correction[0] + (1.0 - p.beta1);
  correction[1] = p.beta2 * correction[1] + (1.0 - p.beta2);
}
