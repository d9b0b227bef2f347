// variants: f2 f4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row_store.glsl"
#include "winograd.glsl"

// U = G w G^T as winograd_product reads it: [frequency][out / 8][in / 4][out % 8], a vec4 of 4 input channels, `out` and `in` being the
// channels of what the product makes and reads. Zero beyond the channels. w is (out, in, 3, 3); or, for the transposed product,
// (in, out, 3, 3), whose taps run backwards. One invocation makes all frequencies of 1 output and 4 input channels.
layout(constant_id = 1) const bool kTransposed = false;
layout(constant_id = 2) const bool kWholeRows = false;  // p.vectors is a multiple of a subgroup's lanes

layout(push_constant) uniform Push {
  int out_channels;
  int in_channels;
  int vectors;  // of a frequency; a multiple of 8
  ROW_DIGITS
} p;

READ1(0, w)
WRITE4(1, transformed)

float weight(int o, int i, int tap) {
  bool inside = o < p.out_channels && i < p.in_channels;
  return kTransposed ? load1_or_zero(w, inside, (i * p.out_channels + o) * 9 + 8 - tap)
                     : load1_or_zero(w, inside, (o * p.in_channels + i) * 9 + tap);
}

void main() {
  int at = int(flat_index());
#ifdef TEXEL
  ALIGN_SPILLS(transformed)
  int row = known_uniform6(int(gl_WorkGroupID.x)) * int(gl_WorkGroupSize.x);
#endif
  if (!kRowStores && at >= p.vectors) return;
  int in4 = (p.in_channels + 3) / 4;
  int block = at / 8;
  int o = block / in4 * 8 + at % 8;
  int i = block % in4 * 4;
  vec4 rows[3][kRead];
  [[unroll]] for (int ky = 0; ky < 3; ++ky) {
    vec4 line[3];
    [[unroll]] for (int kx = 0; kx < 3; ++kx) {
      int tap = ky * 3 + kx;
      line[kx] = vec4(weight(o, i, tap), weight(o, i + 1, tap), weight(o, i + 2, tap), weight(o, i + 3, tap));
    }
    rows[ky] = weight_transform(line);
  }
  [[unroll]] for (int x = 0; x < kRead; ++x) {
    vec4 line[3];
    [[unroll]] for (int ky = 0; ky < 3; ++ky) line[ky] = rows[ky][x];
    vec4 column[kRead] = weight_transform(line);
    [[unroll]] for (int y = 0; y < kRead; ++y) {
      int from = (y * kRead + x) * p.vectors;
#ifdef TEXEL
      if (kRowStores && kWholeRows)
        store4_row(transformed, true, from + row, column[y])
      else if (kRowStores)
        store4_row_below(transformed, from + p.vectors, from + row, column[y])
      else
#endif
        store4(transformed, at + from, column[y])
    }
  }
}
