#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "subgroup.glsl"
#include "row_store.glsl"

// M = U V of every frequency, tile by tile (winograd.glsl): transformed inputs [block][frequency][in / 4][tile], transformed weights
// [frequency][out / 8][in / 4][out % 8], products [block][frequency][out / 4][tile].
// A lane makes kOut4 vectors of 4 output channels at kTiles tiles that lie a workgroup's width apart; a block is the tiles of one
// workgroup. The lanes of a subgroup fetch the weights of 8 output channels together and hand them round, as those of conv_product do.
// Workgroups: x the output channels, so that neighbours share their inputs, y the frequency, z the block.
layout(constant_id = 1) const int kOut4 = 8;  // even
layout(constant_id = 2) const int kTiles = 8;

layout(constant_id = 3) const int kShared = 1;  // blocks of 8 output channels whose weights one fetch brings: 2 with 16 lanes

layout(push_constant) uniform Push {
  int in4;
  int out4;
  int out8;  // blocks of 8 output channels that weights are there for
  int frequencies;
  ROW_DIGITS
} p;

READ4(0, inputs)
READ4(1, weights)
WRITE4(2, products)

void main() {
  ALIGN_SPILLS(products)
  int width = int(gl_WorkGroupSize.x) * kTiles;
  int frequency = int(gl_WorkGroupID.y);
  int plane = int(gl_WorkGroupID.z) * p.frequencies + frequency;
  int out_block = int(gl_WorkGroupID.x) * kOut4;

  vec4 sums[kTiles][kOut4];
  [[unroll]] for (int o = 0; o < kOut4; ++o)
    [[unroll]] for (int r = 0; r < kTiles; ++r) sums[r][o] = vec4(0);

  int from = plane * p.in4 * width + int(gl_LocalInvocationID.x);
  int block_step = p.in4 * 8;
  int lane = int(gl_SubgroupInvocationID);
  int weight = (frequency * p.out8 + out_block / 2 + lane / 8 % kShared) * block_step + lane % 8;
  for (int c = 0; c < p.in4; ++c) {
    vec4 v[kTiles];
    [[unroll]] for (int r = 0; r < kTiles; ++r) v[r] = load4(inputs, from + c * width + r * int(gl_WorkGroupSize.x));
    [[unroll]] for (int b = 0; b < kOut4 / 2; b += kShared) {
      vec4 mine = load4(weights, weight + c * 8 + b * block_step);
      [[unroll]] for (int h = 0; h < 2 * kShared; ++h)
        [[unroll]] for (int o = 0; o < 4; ++o)
          [[unroll]] for (int i = 0; i < 4; ++i) {
            float s = from_lane(mine[i], 4 * h + o);
            [[unroll]] for (int r = 0; r < kTiles; ++r) sums[r][2 * b + h][o] = fma(s, v[r][i], sums[r][2 * b + h][o]);
          }
    }
  }

  int row_plane = known_uniform6(int(gl_WorkGroupID.z)) * p.frequencies + known_uniform2(frequency);
  int row_block = known_uniform4(int(gl_WorkGroupID.x)) * kOut4;
  int to = (row_plane * p.out4 + row_block) * width;
  [[unroll]] for (int o = 0; o < kOut4; ++o)
    [[unroll]] for (int r = 0; r < kTiles; ++r)
      store4_row(products, row_block + o < p.out4, to + o * width + r * int(gl_WorkGroupSize.x), sums[r][o])
}
