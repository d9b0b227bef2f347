// variants: floats vectors
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"

// dw[co][ci][tap] (+)= sum over strips, in order, of partial[strip][co][tap][ci / 4].
// An invocation takes one co and 4 ci with all taps: 4 taps consecutive floats, stored as vectors where ci is a multiple of 4.
layout(constant_id = 1) const uint kTaps = 9;

layout(push_constant) uniform Push {
  uint co;
  uint ci;
  uint ci4;
  uint strips;
  uint strip_vectors;
  uint accumulate;
} p;

READ4(0, partial)
#ifdef VECTORS
WRITE4(1, dw)
#else
WRITE1(1, dw)
#endif

void main() {
  uint at = flat_index();
  if (at >= p.co * p.ci4) return;
  uint o = at / p.ci4;
  uint c = at % p.ci4;
  vec4 sum[kTaps];
  [[unroll]] for (uint tap = 0; tap < kTaps; ++tap) sum[tap] = vec4(0);
  for (uint strip = 0; strip < p.strips; ++strip) {
    uint base = strip * p.strip_vectors + o * kTaps * p.ci4 + c;
    [[unroll]] for (uint tap = 0; tap < kTaps; ++tap) sum[tap] += load4(partial, base + tap * p.ci4);
  }
#ifdef VECTORS
  // Float number f of the 4 taps consecutive ones is channel f / taps, tap f % taps.
  [[unroll]] for (uint v = 0; v < kTaps; ++v) {
    vec4 row;
    [[unroll]] for (uint j = 0; j < 4; ++j) row[j] = sum[(4 * v + j) % kTaps][(4 * v + j) / kTaps];
    add4(dw, at * kTaps + v, row, p.accumulate)
  }
#else
  [[unroll]] for (uint j = 0; j < 4; ++j) {
    if (4 * c + j >= p.ci) return;
    [[unroll]] for (uint tap = 0; tap < kTaps; ++tap)
      add1(dw, (o * p.ci + 4 * c + j) * kTaps + tap, sum[tap][j], p.accumulate)
  }
#endif
}
