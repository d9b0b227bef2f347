// variants: look decide
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// The scale of the loss; what is decided is in graph/ops/loss_scale.h.
// look: sets the flag where an element of a gradient is infinite or no number. One invocation takes 16 vectors; the order in which
// invocations set it changes nothing.
// decide: the state of the next step; one invocation.
#ifdef LOOK
layout(push_constant) uniform Push { uint vectors; } p;
READ4(0, gradient)
WRITEU(1, found)

const uint kVectorsEach = 16;

void main() {
  uint first = flat_index() * kVectorsEach;
  uint last = min(first + kVectorsEach, p.vectors);
  bool any_found = false;
  for (uint i = first; i < last; ++i) {
    uvec4 exponent = floatBitsToUint(load4(gradient, i)) & 0x7f800000u;
    any_found = any_found || any(equal(exponent, uvec4(0x7f800000u)));
  }
  if (any_found) atomicOr(found[0], 1u);
}
#else
layout(push_constant) uniform Push {
  float smallest;
  float largest;
  float interval;
} p;
READU(0, found)
WRITE1(1, state)  // scale, good steps, skipped steps, factor

void main() {
  if (flat_index() != 0) return;
  float scale = state[0];
  if (found[0] != 0) {
    state[0] = scale * 0.5 > p.smallest ? scale * 0.5 : p.smallest;
    state[1] = 0.0;
    state[2] += 1.0;
    state[3] = 0.0;
  } else {
    bool longer = state[1] + 1.0 >= p.interval;
    state[0] = longer ? min(scale * 2.0, p.largest) : scale;
    state[1] = longer ? 0.0 : state[1] + 1.0;
    state[3] = 1.0 / scale;
  }
}
#endif
