#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Weights as conv_cooperative reads them, `out` and `in` being the channels of what the product makes and reads:
//   packed[tap][in / 8][out][8 input channels], in vectors of 4, `out` rounded up to a multiple of 4.
// Whatever lies beyond the channels is zero. The host has `packed` hold float16, so that storing rounds. w is (out, in, taps), or
// (in, out, taps) for the transposed product. One invocation makes all taps of 4 input channels and one output channel; neighbours take
// channels whose weights are neighbours.
layout(push_constant) uniform Push {
  int out_channels;
  int in_channels;
  int taps;
  int transposed;
  int invocations;
} p;

READ1(0, w)
WRITE4(1, packed)

float weight(int o, int i, int tap) {
  int row = p.transposed != 0 ? i * p.out_channels + o : o * p.in_channels + i;
  return load1_or_zero(w, o < p.out_channels && i < p.in_channels, row * p.taps + tap);
}

void main() {
  int at = int(flat_index());
  if (at >= p.invocations) return;
  int in8 = (p.in_channels + 7) / 8;
  int out_padded = p.invocations / (2 * in8);
  int o = p.transposed != 0 ? at % out_padded : at / (2 * in8);
  int i4 = p.transposed != 0 ? at / out_padded : at % (2 * in8);
  for (int tap = 0; tap < p.taps; ++tap) {
    vec4 v = vec4(weight(o, 4 * i4, tap), weight(o, 4 * i4 + 1, tap), weight(o, 4 * i4 + 2, tap), weight(o, 4 * i4 + 3, tap));
    store4(packed, ((tap * in8 + i4 / 2) * out_padded + o) * 2 + i4 % 2, v)
  }
}
