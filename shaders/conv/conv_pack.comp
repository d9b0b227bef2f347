#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Weights and bias as conv_product reads them, `out` and `in` being the channels of what the product makes and reads:
//   packed[out / 8][tap][in / 4][out % 8], a vec4 of 4 input channels; then bias[out / 4], a vec4 of 4 output channels.
// Whatever lies beyond the channels is zero. w is (out, in, taps), or (in, out, taps) where `transposed` is set.
// One invocation makes one vec4.
layout(push_constant) uniform Push {
  int out_channels;
  int in_channels;
  int taps;
  int transposed;
  int has_bias;
  int weight_vectors;
  int vectors;
} p;

READ1(0, w)
READ1(1, bias)
WRITE4(2, packed)

float weight(int o, int tap, int i) {
  int row = p.transposed != 0 ? i * p.out_channels + o : o * p.in_channels + i;
  return load1_or_zero(w, o < p.out_channels && i < p.in_channels, row * p.taps + tap);
}

float bias_of(int o) { return load1_or_zero(bias, p.has_bias != 0 && o < p.out_channels, o); }

void main() {
  int at = int(flat_index());
  if (at >= p.vectors) return;
  vec4 v;
  if (at < p.weight_vectors) {
    int in4 = (p.in_channels + 3) / 4;
    int block = at / 8;
    int i = block % in4 * 4;
    int tap = block / in4 % p.taps;
    int o = block / in4 / p.taps * 8 + at % 8;
    v = vec4(weight(o, tap, i), weight(o, tap, i + 1), weight(o, tap, i + 2), weight(o, tap, i + 3));
  } else {
    int o = (at - p.weight_vectors) * 4;
    v = vec4(bias_of(o), bias_of(o + 1), bias_of(o + 2), bias_of(o + 3));
  }
  store4(packed, at, v)
}
