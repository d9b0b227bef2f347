// variants: forward forward4 backward backward4
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "flat4.glsl"
#if defined(FORWARD4) || defined(BACKWARD4)
#define WIDE
#endif
#include "flat_any.glsl"

// loss = sum over all of (predicted - target)^2 / B. Forward: one invocation sums one strip of units into one term, in sums of 32.
// Backward: dpredicted = scale (predicted - target) dloss with scale = 2 / B, 4 consecutive units an invocation.
layout(push_constant) uniform Push {
  uint units;
  uint strip;
  uint strips;
  float scale;
  uint accumulate;
} p;

READ(0, predicted)
READ(1, target)
#if defined(FORWARD) || defined(FORWARD4)
WRITE1(2, terms)
#else
READ1(2, dloss)
WRITE(3, dpredicted)
#endif

#ifdef WIDE
#define SQUARE(v) dot(v, v)
#else
#define SQUARE(v) ((v) * (v))
#endif

void main() {
#if defined(FORWARD) || defined(FORWARD4)
  uint s = flat_index();
  if (s >= p.strips) return;
  uint end = min((s + 1) * p.strip, p.units);
  float sum = 0.0;
  for (uint first = s * p.strip; first < end; first += 32) {
    float part = 0.0;
    for (uint i = first; i < min(first + 32, end); ++i) {
      VALUE d = LOAD(predicted, i) - LOAD(target, i);
      part += SQUARE(d);
    }
    sum += part;
  }
  terms[s] = sum;
#else
  float factor = p.scale * load1(dloss, 0);
  FOR4(i, flat_index() * 4, p.units,
       { ADD(dpredicted, i, factor * (LOAD(predicted, i) - LOAD(target, i)), p.accumulate) })
#endif
}
