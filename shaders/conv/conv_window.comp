#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "subgroup.glsl"
#include "row_store.glsl"

// The products of conv_product.comp with kernels up to 3 wide and no dilation, for CPU devices:
//   out[n, o, y, x] = bias[o] + sum over ky, kx, i of in[n, i, y', x'] w[o, tap, i]
// One invocation makes kOut channels of kPixels pixels in a row, of every phase of columns, so that one stretch of an input row serves
// all columns of the kernel: fetches are what short sums over few channels spend their time on. Invocations next to each other
// take stretches next to each other, then the next row, then the next image.
//
// Output row y = row · phases + a of phase a (workgroup z) reads input rows row · stride + base[a] + j · step for its taps
// ky = first[a] + j · tap_step, j = 0 … taps[a] − 1. Column phases do the same in straight code: forward, x' = x · stride + kx − padding;
// transposed, x' = (x + padding − kx) / stride wherever that is whole.
// in and out are NC4HW4, weights as conv_pack leaves them. Each lane of a subgroup fetches one vector of the weights that an
// iteration takes and hands it round.
layout(constant_id = 1) const int kOut = 8;         // a multiple of 8, or all channels there are
layout(constant_id = 2) const int kPixels = 8;      // of each phase
layout(constant_id = 3) const uint kAccumulate = 0;  // 1: out += …
layout(constant_id = 4) const int kKernel = 3;
layout(constant_id = 5) const int kStride = 1;
layout(constant_id = 6) const int kPadding = 1;
layout(constant_id = 7) const bool kTransposed = false;
layout(constant_id = 8) const int kIn = 4;      // channels of a vector that count: 4, or fewer where there are fewer in all
layout(constant_id = 9) const bool kWhole = false;  // columns of a phase are a multiple of kPixels, inputs too
layout(constant_id = 10) const bool kKnown = false;  // stores lane by lane to addresses that are known to be uniform (row_store.glsl)

layout(push_constant) uniform Push {
  int n;
  int in4;  // vectors of 4 input channels
  int out4;
  int h;  // of the input
  int w;
  int out_h;
  int out_w;
  int kernel;
  int stride;
  int step;
  int tap_step;
  int phases;
  int first[2];
  int taps[2];
  int base[2];
  int tiles;   // of output channels
  int bias;    // where it starts in `weights`
  int blocks;  // stretches of a row
  ROW_DIGITS
} p;

READ4(0, x)
READ4(1, weights)
WRITE4(2, y)

const int kOutside = -1073741824;  // stays negative however far a channel is from the first
const int kPhases = kTransposed ? kStride : 1;
const int kStep = kTransposed ? 1 : kStride;  // columns from one pixel's input to the next
const int kPositions = kPixels * kPhases;
// Leftmost and rightmost input of the first pixel, over phases.
const int kLow = kTransposed ? -((kKernel - 1 - kPadding + kStride - 1) / kStride) : -kPadding;
const int kHigh = kTransposed ? (kStride - 1 + kPadding) / kStride : kKernel - 1 - kPadding;
const int kValues = (kPixels - 1) * kStep + kHigh - kLow + 1;
const int kOut4 = (kOut + 3) / 4;
// An iteration takes kKernel vectors of weights for each output channel and input vector: 8 channels of one tap lie together.
const int kBlocks = (kOut + 7) / 8;
const int kPairs = kBlocks * kKernel;
const int kShare = int(kSubgroupSize) / 8;
const int kFetches = (kPairs + kShare - 1) / kShare;

#ifdef TEXEL
#define input4(at) (kZeroOutside ? load4(x, at) : load4_or_zero(x, (at) >= 0, at))
#else
#define input4(at) load4_or_zero(x, (at) >= 0, at)
#endif

float sums[kOut4 * 4][kPositions];

struct Stretch {
  int image;  // p.n or more beyond the last one
  int row;    // of the phase
  int column;
};

// The stretch `on` further than one of an image's `first_row`; numbers are small enough for floats.
Stretch stretch_at(int rows, int first_image, int first_row, int on) {
  int rows_on = int((float(on) + 0.5) / float(p.blocks));
  int down = first_row + rows_on;
  int images_on = int((float(down) + 0.5) / float(rows));
  return Stretch(first_image + images_on, down - images_on * rows, (on - rows_on * p.blocks) * kPixels);
}

int first_output(Stretch s, int a, int out_block, int size) {
  return (s.image * p.out4 + out_block * kOut4) * size + (s.row * p.phases + a) * p.out_w + s.column * kPhases;
}
bool lies_inside(Stretch s, int r) { return s.image < p.n && (kWhole || s.column * kPhases + r < p.out_w); }

vec4 sum_of(int o4, int r) {
  vec4 sum;
  [[unroll]] for (int o = 0; o < 4; ++o) sum[o] = 4 * o4 + o < kOut ? sums[4 * o4 + o][r] : 0.0;
  return sum;
}

#ifdef TEXEL
// Every lane's stretch is found once more for all lanes, from what is known to be uniform (row_store.glsl).
void store_known(int a, int rows, int first_image, int first_row, int first_block, int out_block) {
  int size = p.out_h * p.out_w;
  a = known_uniform2(a);
  rows = (p.out_h - a + p.phases - 1) / p.phases;
  first_image = known_uniform6(first_image);
  first_row = known_uniform4(first_row);
  first_block = known_uniform4(first_block);
  out_block = known_uniform4(out_block);
  int at[kMostLanes];
  Stretch s[kMostLanes];
  [[unroll]] for (int l = 0; l < kMostLanes; ++l) {
    s[l] = stretch_at(rows, first_image, first_row, first_block + l);
    at[l] = first_output(s[l], a, out_block, size);
  }
  [[unroll]] for (int o4 = 0; o4 < kOut4; ++o4) {
    bool there = out_block * kOut4 + o4 < p.out4;
    [[unroll]] for (int r = 0; r < kPositions; r += 2) {
      u64vec2 words = ROW_WORDS(y, sum_of(o4, r));
      u64vec2 next = ROW_WORDS(y, sum_of(o4, r + 1));
      [[unroll]] for (int l = 0; l < kMostLanes; ++l) {
        int to = at[l] + o4 * size + r;
        if (kWhole) {  // which makes p.out_w even
          STORE_LANES(y, there && lies_inside(s[l], r), to, words, l, next, l)
        } else {
          STORE_LANE(y, there && lies_inside(s[l], r), to, words, l)
          STORE_LANE(y, there && lies_inside(s[l], r + 1), to + 1, next, l)
        }
      }
    }
  }
}
#endif

void main() {
#ifdef TEXEL
  if (kKnown) ALIGN_SPILLS(y)
#endif
  int a = int(gl_WorkGroupID.z);
  int rows = (p.out_h - a + p.phases - 1) / p.phases;
  int group = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x);
  int tile = group / p.tiles;
  int out_block = group - tile * p.tiles;  // of kOut channels
  // One exact division for the workgroup; from there on numbers are small enough for floats.
  int begin = tile * int(kSubgroupSize);
  int first_image = begin / (rows * p.blocks);
  if (!kKnown && first_image >= p.n) return;
  int within = begin - first_image * (rows * p.blocks);
  int first_row = within / p.blocks;
  int first_block = within - first_row * p.blocks;
  Stretch s = stretch_at(rows, first_image, first_row, first_block + int(gl_SubgroupInvocationID));

  [[unroll]] for (int o4 = 0; o4 < kOut4; ++o4) {
    vec4 start = load4(weights, p.bias + out_block * kOut4 + o4);
    [[unroll]] for (int o = 0; o < 4; ++o)
      [[unroll]] for (int r = 0; r < kPositions; ++r) sums[4 * o4 + o][r] = start[o];
  }

  // Where each lane's weights lie, from those of the first tap and input vector on.
  int block_stride = p.kernel * p.kernel * p.in4 * 8;
  int weight_at[kFetches];
  [[unroll]] for (int f = 0; f < kFetches; ++f) {
    int pair = min(f * kShare + int(gl_SubgroupInvocationID) / 8, kPairs - 1);
    weight_at[f] = (out_block * kBlocks + pair / kKernel) * block_stride + (pair % kKernel) * p.in4 * 8 +
                   int(gl_SubgroupInvocationID) % 8;
  }

  int x0 = s.column * kStep + kLow;
  int y0 = s.image < p.n ? s.row * p.stride + p.base[a] : kOutside;
  int plane = p.h * p.w;
  int at0 = s.image * p.in4 * plane;
  int tap_row = p.first[a] * p.kernel * p.in4 * 8;
  int c = 0;
  // One loop over rows and channels: every level of loops copies all sums.
  for (int t = p.taps[a] * p.in4; t > 0; --t) {
    bool inside = uint(y0) < uint(p.h);
    int row_at = at0 + y0 * p.w + x0;
    int at = row_at + c * plane;
    vec4 v[kValues];
    [[unroll]] for (int i = 0; i < kValues; ++i) {
      bool within_row = inside;
      if (!kWhole || i + kLow < 0) within_row = within_row && x0 + i >= 0;
      if (!kWhole || i + kLow > (kPixels - 1) * kStep) within_row = within_row && x0 + i < p.w;
      v[i] = input4(within_row ? at + i : kOutside);
    }
    vec4 mine[kFetches];
    [[unroll]] for (int f = 0; f < kFetches; ++f) mine[f] = load4(weights, weight_at[f] + tap_row + c * 8);
    [[unroll]] for (int o = 0; o < kOut; ++o)
      [[unroll]] for (int kx = 0; kx < kKernel; ++kx) {
        int pair = o / 8 * kKernel + kx;
        [[unroll]] for (int i = 0; i < kIn; ++i) {
          float s = from_lane(mine[pair / kShare][i], pair % kShare * 8 + o % 8);
          [[unroll]] for (int b = 0; b < kPhases; ++b) {
            int from = kTransposed ? b + kPadding - kx : kx - kPadding;
            int divided = kTransposed ? (from + 8 * kStride) / kStride - 8 : from;
            if (!kTransposed || divided * kStride == from)
              [[unroll]] for (int r = 0; r < kPixels; ++r)
                sums[o][r * kPhases + b] = fma(s, v[r * kStep + divided - kLow][i], sums[o][r * kPhases + b]);
          }
        }
      }
    ++c;
    bool next = c == p.in4;
    c = next ? 0 : c;
    y0 += next ? p.step : 0;
    tap_row += next ? p.tap_step * p.kernel * p.in4 * 8 : 0;
  }

#ifdef TEXEL
  if (kKnown) {
    store_known(a, rows, first_image, first_row, first_block, out_block);
    return;
  }
#endif
  int size = p.out_h * p.out_w;
  int out_row = first_output(s, a, out_block, size);
  [[unroll]] for (int o4 = 0; o4 < kOut4; ++o4)
    if (out_block * kOut4 + o4 < p.out4)
      [[unroll]] for (int r = 0; r < kPositions; ++r)
        if (lies_inside(s, r)) add4(y, out_row + o4 * size + r, sum_of(o4, r), kAccumulate)
}
