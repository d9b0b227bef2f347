// variants: any forward transposed
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"

// Weights and bias as conv_product reads them, `out` and `in` being the channels of what the product makes and reads:
//   packed[out / 8][tap][in / 4][out % 8], a vec4 of 4 input channels; then bias[out / 4], a vec4 of 4 output channels.
// Whatever lies beyond the channels is zero. w is (out, in, taps), or (in, out, taps) for the transposed product.
//   any         one invocation makes one vec4 of either
//   forward     one makes all taps of 1 output and 4 input channels; `in` must be a multiple of 4
//   transposed  one makes all taps of 4 output and 4 input channels; `out` must be a multiple of 4
// The last two read w in whole vectors. Invocations after those of the weights make the bias.
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

#ifdef ANY
READ1(0, w)
#else
READ4(0, w)
layout(constant_id = 1) const int kTaps = 1;
#endif
READ1(1, bias)
WRITE4(2, packed)

float bias_of(int o) { return load1_or_zero(bias, p.has_bias != 0 && o < p.out_channels, o); }

// Where the vector of the first tap goes; the next tap's is 8 · in / 4 further on.
int place(int o, int i4, int in4) { return (o / 8 * p.taps * in4 + i4) * 8 + o % 8; }

#ifdef ANY
float weight(int o, int tap, int i) {
  int row = p.transposed != 0 ? i * p.out_channels + o : o * p.in_channels + i;
  return load1_or_zero(w, o < p.out_channels && i < p.in_channels, row * p.taps + tap);
}

void pack(int at) {
  int in4 = (p.in_channels + 3) / 4;
  int block = at / 8;
  int i = block % in4 * 4;
  int tap = block / in4 % p.taps;
  int o = block / in4 / p.taps * 8 + at % 8;
  vec4 v = vec4(weight(o, tap, i), weight(o, tap, i + 1), weight(o, tap, i + 2), weight(o, tap, i + 3));
  store4(packed, at, v)
}
#endif

#ifdef FORWARD
void pack(int at) {
  int in4 = p.in_channels / 4;
  int o = at / 8 / in4 * 8 + at % 8;
  int i4 = at / 8 % in4;
  vec4 row[kTaps];  // 4 input channels × taps
  [[unroll]] for (int k = 0; k < kTaps; ++k) row[k] = load4_or_zero(w, o < p.out_channels, (o * in4 + i4) * kTaps + k);
  int to = place(o, i4, in4);
  [[unroll]] for (int k = 0; k < kTaps; ++k) {
    vec4 v;
    [[unroll]] for (int i = 0; i < 4; ++i) v[i] = row[(i * kTaps + k) / 4][(i * kTaps + k) % 4];
    store4(packed, to + k * 8 * in4, v)
  }
}
#endif

#ifdef TRANSPOSED
void pack(int at) {
  int in4 = (p.in_channels + 3) / 4;
  int o = (at / 2 / in4 * 2 + at % 2) * 4;
  int i4 = at / 2 % in4;
  vec4 row[4][kTaps];  // 4 output channels × taps, for each of 4 input channels
  [[unroll]] for (int i = 0; i < 4; ++i)
    [[unroll]] for (int k = 0; k < kTaps; ++k)
      row[i][k] = load4_or_zero(w, o < p.out_channels && 4 * i4 + i < p.in_channels,
                                ((4 * i4 + i) * p.out_channels + o) / 4 * kTaps + k);
  int to = place(o, i4, in4);
  [[unroll]] for (int c = 0; c < 4; ++c)
    [[unroll]] for (int k = 0; k < kTaps; ++k) {
      vec4 v;
      [[unroll]] for (int i = 0; i < 4; ++i) v[i] = row[i][(c * kTaps + k) / 4][(c * kTaps + k) % 4];
      store4(packed, to + c + k * 8 * in4, v)
    }
}
#endif

void main() {
  int at = int(flat_index());
  if (at >= p.invocations) return;
  if (at < p.weight_invocations) {
    pack(at);
  } else {
    int o = (at - p.weight_invocations) * 4;
    vec4 v = vec4(bias_of(o), bias_of(o + 1), bias_of(o + 2), bias_of(o + 3));
    store4(packed, p.weight_vectors + o / 4, v)
  }
}
