#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "subgroup.glsl"

// partial[strip][ci][tap][co / 4] = sum over the strip's pixels of dy[n][co][yo][xo] x[n][ci][yo stride + ky dilation - padding][...],
// held in registers, for CPU devices: no shared memory, and many products for each fetch.
//
// A workgroup is one subgroup. Its lanes form slots of kLanes; a slot takes gradient rows of its own, kPixels pixels a round, and each
// lane of it 4 output channels of its own. Values of x serve all lanes of a slot: its lanes fetch them together and hand them round.
// Every lane sums kChannels input channels times all taps times its 4 output channels; in the end the slots' sums are added as a tree.
layout(constant_id = 1) const uint kKernel = 3;
layout(constant_id = 2) const uint kStride = 1;
layout(constant_id = 3) const uint kLanes = 1;      // divides the subgroup
layout(constant_id = 4) const uint kChannels = 4;   // a multiple of 4, or less than 4 where there are no more
layout(constant_id = 5) const uint kPixels = 8;
layout(constant_id = 6) const bool kWindow = true;  // one stretch of x serves all taps of a row (dilation 1), or each tap has its own

layout(push_constant) uniform Push {
  uint ci;
  uint ci4;
  int h;
  int w;
  uint co4;
  uint ho;
  uint wo;
  int padding;
  int dilation;
  uint image_blocks;  // blocks are as many gradient rows as there are slots, the last of an image maybe partly outside
  uint strip_blocks;  // blocks are numbered through the batch
  uint blocks;
} p;

READ4(0, x)
READ4(1, dy)
WRITE4(2, partial)

const uint kSlots = kSubgroupSize / kLanes;
const uint kTaps = kKernel * kKernel;
const uint kQuads = (kChannels + 3) / 4;
const uint kQuadChannels = kChannels < 4 ? kChannels : 4;
// Of one row of x: stretches, values of each that are used, fetches that bring them.
const uint kStretches = kWindow ? 1 : kKernel;
const uint kValues = kWindow ? (kPixels - 1) * kStride + kKernel : kPixels;
const uint kFetches = (kValues + kLanes - 1) / kLanes;
const uint kStep = kWindow ? 1 : kStride;

void main() {
  uint lane = gl_SubgroupInvocationID % kLanes;
  uint slot = gl_SubgroupInvocationID / kLanes;
  uint first_lane = gl_SubgroupInvocationID - lane;
  uint o = gl_WorkGroupID.x * kLanes + lane;
  uint first_quad = gl_WorkGroupID.y * kQuads;
  uint strip = gl_WorkGroupID.z;

  vec4 sum[kChannels * kTaps];
  [[unroll]] for (uint i = 0; i < kChannels * kTaps; ++i) sum[i] = vec4(0);

  uint first = strip * p.strip_blocks;
  uint rounds = (min(first + p.strip_blocks, p.blocks) - first) * ((p.wo + kPixels - 1) / kPixels);
  uint n = first / p.image_blocks;
  uint block = first % p.image_blocks;
  uint xo = 0;
  // One loop over blocks and pixels together: every level of loops costs lavapipe masked copies of all sums.
  for (; rounds > 0; --rounds) {
    uint row = block * kSlots + slot;
    bool inside = row < p.ho && o < p.co4;
    uint dy_at = ((n * p.co4 + o) * p.ho + row) * p.wo + xo;
    vec4 g[kPixels];
    [[unroll]] for (uint i = 0; i < kPixels; ++i) g[i] = load4_or_zero(dy, inside && xo + i < p.wo, dy_at + i);

    [[unroll]] for (uint ky = 0; ky < kKernel; ++ky) {
      int y = int(row * kStride) + int(ky) * p.dilation - p.padding;
      [[unroll]] for (uint quad = 0; quad < kQuads; ++quad) {
        bool row_inside = y >= 0 && y < p.h && first_quad + quad < p.ci4;
        int row_at = (int(n * p.ci4 + first_quad + quad) * p.h + y) * p.w;
        [[unroll]] for (uint stretch = 0; stretch < kStretches; ++stretch) {
          vec4 v[kFetches];
          int column = int(xo * kStride + lane * kStep) + int(stretch) * p.dilation - p.padding;
          [[unroll]] for (uint f = 0; f < kFetches; ++f) {
            int at = column + int(f * kLanes * kStep);
            v[f] = load4_or_zero(x, row_inside && at >= 0 && at < p.w, row_at + at);
          }
          [[unroll]] for (uint c = 0; c < kQuadChannels; ++c) {
            uint to = ((quad * 4 + c) * kKernel + ky) * kKernel;
            [[unroll]] for (uint i = 0; i < kValues; ++i) {
              float value = v[i / kLanes][c];
              if (kLanes > 1) value = from_lane(value, first_lane + i % kLanes);
              if (kWindow) {
                [[unroll]] for (uint kx = 0; kx < kKernel; ++kx)
                  if (i >= kx && (i - kx) % kStride == 0 && (i - kx) / kStride < kPixels)
                    sum[to + kx] = fma(vec4(value), g[(i - kx) / kStride], sum[to + kx]);
              } else {
                sum[to + stretch] = fma(vec4(value), g[i], sum[to + stretch]);
              }
            }
          }
        }
      }
    }

    xo += kPixels;
    bool next_block = xo >= p.wo;
    xo = next_block ? 0 : xo;
    block += next_block ? 1 : 0;
    bool next_image = block >= p.image_blocks;
    block = next_image ? 0 : block;
    n += next_image ? 1 : 0;
  }

  [[unroll]] for (uint i = 0; i < kChannels * kTaps; ++i) {
    [[unroll]] for (uint bit = 0; bit < 7; ++bit)
      if ((1u << bit) >= kLanes && (1u << bit) < kSubgroupSize)
        sum[i] += subgroupShuffle(sum[i], gl_SubgroupInvocationID ^ (1u << bit));
  }
  if (slot == 0 && o < p.co4) {
    [[unroll]] for (uint c = 0; c < kChannels; ++c) {
      uint to = strip * p.ci4 * 4 + first_quad * 4 + c;
      if (first_quad * 4 + c < p.ci) {
        [[unroll]] for (uint tap = 0; tap < kTaps; ++tap) store4(partial, (to * kTaps + tap) * p.co4 + o, sum[c * kTaps + tap])
      }
    }
  }
}
