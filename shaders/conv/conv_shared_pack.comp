#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Weights and bias as conv_shared reads them, `out` and `in` being the channels of what the product makes and reads:
//   packed[tap][in][out / 4], a vec4 of 4 output channels, `in` rounded up to a multiple of 4; then bias[out / 4].
// Whatever lies beyond the channels is zero. w is (out, in, taps), or (in, out, taps) for the transposed product. One invocation
// makes all taps of one input and 4 output channels; neighbours take channels whose weights are neighbours. Invocations after those of
// the weights make the bias.
layout(push_constant) uniform Push {
  int out_channels;
  int in_channels;
  int taps;
  int transposed;
  int has_bias;
  int weight_vectors;
  int weight_invocations;
  int invocations;
} p;

READ1(0, w)
READ1(1, bias)
WRITE4(2, packed)

float weight(int o, int i, int tap) {
  int row = p.transposed != 0 ? i * p.out_channels + o : o * p.in_channels + i;
  return load1_or_zero(w, o < p.out_channels && i < p.in_channels, row * p.taps + tap);
}

float bias_of(int o) { return load1_or_zero(bias, p.has_bias != 0 && o < p.out_channels, o); }

void main() {
  int at = int(flat_index());
  if (at >= p.invocations) return;
  if (at < p.weight_invocations) {
    int out4 = (p.out_channels + 3) / 4;
    int in_padded = p.weight_invocations / out4;
    int o4 = p.transposed != 0 ? at % out4 : at / in_padded;
    int i = p.transposed != 0 ? at / out4 : at % in_padded;
    for (int tap = 0; tap < p.taps; ++tap) {
      vec4 v = vec4(weight(4 * o4, i, tap), weight(4 * o4 + 1, i, tap), weight(4 * o4 + 2, i, tap), weight(4 * o4 + 3, i, tap));
      store4(packed, (tap * in_padded + i) * out4 + o4, v)
    }
  } else {
    int o4 = at - p.weight_invocations;
    vec4 v = vec4(bias_of(4 * o4), bias_of(4 * o4 + 1), bias_of(4 * o4 + 2), bias_of(4 * o4 + 3));
    store4(packed, p.weight_vectors + o4, v)
  }
}
