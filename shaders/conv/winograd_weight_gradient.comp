// variants: f2 f4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "winograd.glsl"

// dw[co][ci][ky][kx] (+)= G^T dU G, dU[frequency][co][ci / 4] as winograd_weight_product leaves it. An invocation takes 1 output and
// 4 input channels. dw is written in vectors where kVectors says that ci is a multiple of 4.
layout(constant_id = 1) const bool kVectors = true;

layout(push_constant) uniform Push {
  int co;
  int ci;
  int in4;
  int vectors;  // of a frequency
  uint accumulate;
} p;

READ4(0, product)
WRITE4(1, dw4)
WRITE1(2, dw1)

void main() {
  int at = int(flat_index());
  if (at >= p.co * p.in4) return;
  vec4 rows[kRead][3];
  [[unroll]] for (int y = 0; y < kRead; ++y) {
    vec4 line[kRead];
    [[unroll]] for (int x = 0; x < kRead; ++x) line[x] = load4(product, (y * kRead + x) * p.vectors + at);
    rows[y] = weight_gradient_transform(line);
  }
  vec4 taps[9];
  [[unroll]] for (int kx = 0; kx < 3; ++kx) {
    vec4 line[kRead];
    [[unroll]] for (int y = 0; y < kRead; ++y) line[y] = rows[y][kx];
    vec4 column[3] = weight_gradient_transform(line);
    [[unroll]] for (int ky = 0; ky < 3; ++ky) taps[3 * ky + kx] = column[ky];
  }
  if (kVectors) {
    // The 36 floats of 4 channels and 9 taps follow one another.
    [[unroll]] for (int v = 0; v < 9; ++v) {
      vec4 four;
      [[unroll]] for (int k = 0; k < 4; ++k) four[k] = taps[(4 * v + k) % 9][(4 * v + k) / 9];
      add4(dw4, at * 9 + v, four, p.accumulate)
    }
  } else {
    int co = at / p.in4;
    int ci = (at - co * p.in4) * 4;
    [[unroll]] for (int i = 0; i < 4; ++i)
      if (ci + i < p.ci) {
        [[unroll]] for (int tap = 0; tap < 9; ++tap) add1(dw1, (co * p.ci + ci + i) * 9 + tap, taps[tap][i], p.accumulate)
      }
  }
}
