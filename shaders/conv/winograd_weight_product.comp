#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row_store.glsl"
#include "subgroup.glsl"

// dU[frequency][co][ci / 4] (+)= Σ tiles D[co] V[ci] of a chunk, V and D as winograd_input and winograd_gradient leave them:
// [block][frequency][channels / 4][tile].
// A lane takes 4 kOut4 output channels and kIn4 vectors of 4 input channels, which lie a workgroup's width apart. Values of D serve all
// lanes: those of a subgroup fetch 8 tiles' together and hand them round.
// Workgroups: x the output channels, y the input channels, z the frequency.
layout(constant_id = 1) const int kOut4 = 8;
layout(constant_id = 2) const int kIn4 = 1;
layout(constant_id = 3) const uint kAccumulate = 0;
layout(constant_id = 4) const int kShared = 1;       // vectors of output channels that one fetch brings: 2 with 16 lanes
layout(constant_id = 5) const bool kRows = false;    // input channels are whole subgroups' vectors, and are stored by rows

layout(push_constant) uniform Push {
  int in4;
  int out4;
  int blocks;
  int width;  // of a block: tiles, a multiple of 8
  int frequencies;
  ROW_DIGITS
} p;

READ4(0, inputs)
READ4(1, gradients)
WRITE4(2, product)
READ4(3, old)  // product, for rows

vec4 sums[4 * kOut4][kIn4];

#ifdef TEXEL
void store_rows() {
  int out_block = known_uniform4(int(gl_WorkGroupID.x)) * kOut4;
  int in_block = known_uniform4(int(gl_WorkGroupID.y)) * int(gl_WorkGroupSize.x) * kIn4;
  int first = known_uniform2(int(gl_WorkGroupID.z)) * p.out4 * 4;
  [[unroll]] for (int o = 0; o < 4 * kOut4; ++o) {
    int channel = 4 * out_block + o;
    [[unroll]] for (int i = 0; i < kIn4; ++i) {
      int vector = in_block + i * int(gl_WorkGroupSize.x);
      int row = (first + channel) * p.in4 + vector;
      vec4 v = sums[o][i];
      if (kAccumulate != 0) v += load4(old, row + int(gl_LocalInvocationID.x));
      store4_row(product, channel < 4 * p.out4 && vector < p.in4, row, v)
    }
  }
}
#endif

void main() {
#ifdef TEXEL
  if (kRows) ALIGN_SPILLS(product)
#endif
  int frequency = int(gl_WorkGroupID.z);
  int out_block = int(gl_WorkGroupID.x) * kOut4;
  int in_block = int(gl_WorkGroupID.y * gl_WorkGroupSize.x) * kIn4 + int(gl_LocalInvocationID.x);

  [[unroll]] for (int o = 0; o < 4 * kOut4; ++o)
    [[unroll]] for (int i = 0; i < kIn4; ++i) sums[o][i] = vec4(0);

  // Lanes and vectors beyond the channels read those of the last one and store nothing.
  int in_at[kIn4];
  [[unroll]] for (int i = 0; i < kIn4; ++i)
    in_at[i] = (frequency * p.in4 + min(in_block + i * int(gl_WorkGroupSize.x), p.in4 - 1)) * p.width;
  int lane = int(gl_SubgroupInvocationID);
  int out_at[kOut4 / kShared];
  [[unroll]] for (int o = 0; o < kOut4 / kShared; ++o)
    out_at[o] = (frequency * p.out4 + min(out_block + o * kShared + lane / 8 % kShared, p.out4 - 1)) * p.width + lane % 8;

  // One loop over blocks and tiles together: every level of loops costs lavapipe masked copies of all sums.
  int in_shift = 0;
  int out_shift = 0;
  int within = 0;
  for (int rounds = p.blocks * p.width / 8; rounds > 0; --rounds) {
    vec4 d[kOut4 / kShared];
    [[unroll]] for (int o = 0; o < kOut4 / kShared; ++o) d[o] = load4(gradients, out_at[o] + out_shift);
    vec4 v[kIn4][8];
    [[unroll]] for (int i = 0; i < kIn4; ++i)
      [[unroll]] for (int t = 0; t < 8; ++t) v[i][t] = load4(inputs, in_at[i] + in_shift + t);
    [[unroll]] for (int o = 0; o < 4 * kOut4; ++o)
      [[unroll]] for (int t = 0; t < 8; ++t) {
        float s = from_lane(d[o / 4 / kShared][o % 4], o / 4 % kShared * 8 + t);
        [[unroll]] for (int i = 0; i < kIn4; ++i) sums[o][i] = fma(vec4(s), v[i][t], sums[o][i]);
      }
    within += 8;
    bool next = within == p.width;
    within = next ? 0 : within;
    in_shift += 8 + (next ? (p.frequencies * p.in4 - 1) * p.width : 0);
    out_shift += 8 + (next ? (p.frequencies * p.out4 - 1) * p.width : 0);
  }

#ifdef TEXEL
  if (kRows) {
    store_rows();
    return;
  }
#endif
  [[unroll]] for (int o = 0; o < 4 * kOut4; ++o) {
    int channel = 4 * out_block + o;
    [[unroll]] for (int i = 0; i < kIn4; ++i) {
      int vector = in_block + i * int(gl_WorkGroupSize.x);
      if (channel < 4 * p.out4 && vector < p.in4)
        add4(product, (frequency * p.out4 * 4 + channel) * p.in4 + vector, sums[o][i], kAccumulate)
    }
  }
}
