// variants: shuffle uniform
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "product_remainder.glsl"
#include "row_store.glsl"

// A convolution, forward or transposed, as an implicit product of matrices held in registers:
//   out[n, o, ya, xb] = bias[o] + Σ tap,i  in[n, i, ya' , xb'] · w[o, tap, i]
// Output row y = row · phases + a of phase a reads input rows y' = row · stride + base[a] + j · step for its taps
// ky = first[a] + j · tap_step, j = 0 … taps[a] − 1; columns likewise. One phase is a forward convolution or the transposed one of
// stride 1; the transposed convolution of stride 2 has two, so that it never multiplies by the zeros between its inputs.
//
// in and out are NC4HW4, weights as conv_pack leaves them. One invocation makes kOut4 vectors of 4 output channels at kPixels pixels
// that lie a workgroup's width apart; pixels of a phase are numbered through images and rows. Workgroup z is the phase,
// (x, y) the tile, output channels running fastest so that neighbours share their inputs. Any sizes.
// The variants differ in how invocations of the same output channels share weights: each lane of a subgroup fetches the weights of one of
// 8 output channels and hands them round (lanes >= 8), or all of them load the same address.
layout(constant_id = 1) const int kOut4 = 1;
layout(constant_id = 2) const int kPixels = 1;
layout(constant_id = 3) const uint kAccumulate = 0;  // 1: out += …
layout(constant_id = 4) const int kIn4 = 0;          // p.in4, for straight code; 0: a loop
layout(constant_id = 5) const uint kExact = 0;       // 1: what sums and products round off is kept and added at the end
layout(constant_id = 6) const bool kRows = false;    // pixels of a row of lanes lie in one image, one after the other, and are stored so
const int kBlocks = (kOut4 + 1) / 2;                 // of 8 output channels
const int kHalves = kOut4 < 2 ? 1 : 2;               // vectors of a block

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
  int tiles;  // of output channels
  int bias;   // where it starts in `weights`
  ROW_DIGITS
} p;

READ4(0, x)
READ4(1, weights)
WRITE4(2, y)

const int kOutside = -1073741824;  // stays negative however far a channel is from the first

#ifdef SHUFFLE
#include "subgroup.glsl"
#endif

#ifdef TEXEL
#define input4(at, shift) (kZeroOutside ? load4(x, (at) + (shift)) : load4_or_zero(x, (at) >= 0, (at) + (shift)))
#else
#define input4(at, shift) load4_or_zero(x, (at) >= 0, (at) + (shift))
#endif

// Pixels of this invocation: image (or beyond the last one), row and column within the phase.
int image[kPixels];
int row[kPixels];
int column[kPixels];

void find_pixels(int tile, int rows, int columns) {
  // One exact division for the tile; from there on numbers are small enough for floats.
  int begin = tile * int(gl_WorkGroupSize.x) * kPixels;
  int first_image = begin / (rows * columns);
  int within = begin - first_image * (rows * columns);
  int first_row = within / columns;
  int first_column = within - first_row * columns;
  [[unroll]] for (int r = 0; r < kPixels; ++r) {
    int c = first_column + r * int(gl_WorkGroupSize.x) + int(gl_LocalInvocationID.x);
    int rows_on = int((float(c) + 0.5) / float(columns));
    column[r] = c - rows_on * columns;
    int down = first_row + rows_on;
    int images_on = int((float(down) + 0.5) / float(rows));
    row[r] = down - images_on * rows;
    image[r] = first_image + images_on;
  }
}

vec4 sums[kPixels][kOut4];
vec4 lost[kPixels][kOut4];  // with kExact

// sums += s · v, and what that rounds off to `lost`: Knuth's two-sum, and the product's own remainder.
void add_exactly(int r, int o4, int o, float s, float v) {
  precise float term = s * v;
  precise float before = sums[r][o4][o];
  precise float sum = before + term;
  precise float added = sum - before;
  precise float error = (before - (sum - added)) + (term - added);
  sums[r][o4][o] = sum;
  lost[r][o4][o] += error + product_remainder(s, v, term);
}

#ifdef SHUFFLE
#define LOAD_WEIGHTS(from) vec4 mine = load4(weights, (from) + int(gl_SubgroupInvocationID & 7u));
#define WEIGHT(o, i) from_lane(mine[i], o)
#else
#define LOAD_WEIGHTS(from) \
  vec4 all[8];             \
  [[unroll]] for (int o = 0; o < 4 * kHalves; ++o) all[o] = load4(weights, (from) + o);
#define WEIGHT(o, i) all[o][i]
#endif

// Adds 4 input channels, at `at[r] + shift`, times the weights of 8 output channels from `block` on, of the next 8 `block_stride`
// further on, … Two things were measured on lavapipe: with sums of 4 channels as one vector in the innermost loop it is 15 % slower;
// and where a loop's end is not a constant that can be seen, it is not unrolled, and sums live in memory (20 times slower).
void add_channels(int at[kPixels], int shift, int block, int block_stride) {
  vec4 v[kPixels];
  [[unroll]] for (int r = 0; r < kPixels; ++r) v[r] = input4(at[r], shift);
  [[unroll]] for (int b = 0; b < kBlocks; ++b) {
    LOAD_WEIGHTS(block + b * block_stride)
    [[unroll]] for (int h = 0; h < kHalves; ++h)
      [[unroll]] for (int o = 0; o < 4; ++o)
        [[unroll]] for (int i = 0; i < 4; ++i) {
          float s = WEIGHT(4 * h + o, i);
          [[unroll]] for (int r = 0; r < kPixels; ++r)
            if (kExact != 0)
              add_exactly(r, 2 * b + h, o, s, v[r][i]);
            else
              sums[r][2 * b + h][o] = fma(s, v[r][i], sums[r][2 * b + h][o]);
        }
  }
}

void add_taps(int a, int b, int out_block) {
  int block_stride = p.kernel * p.kernel * p.in4 * 8;
  int begin = out_block / 2 * block_stride;
  // Where the tap at offset (0, 0) reads; what lies beyond the last image is outside every row.
  int yi[kPixels], xi[kPixels], at_in[kPixels];
  [[unroll]] for (int r = 0; r < kPixels; ++r) {
    yi[r] = image[r] < p.n ? row[r] * p.stride : kOutside;
    xi[r] = column[r] * p.stride;
    at_in[r] = (image[r] * p.in4 * p.h + yi[r]) * p.w + xi[r];
  }
  // One loop for both directions: every level of loops copies all sums.
  int j = 0;
  int k = 0;
  for (int t = 0; t < p.taps[a] * p.taps[b]; ++t) {
    int dy = p.base[a] + j * p.step;
    int dx = p.base[b] + k * p.step;
    int at[kPixels];
    [[unroll]] for (int r = 0; r < kPixels; ++r) {
      bool inside = uint(yi[r] + dy) < uint(p.h) && uint(xi[r] + dx) < uint(p.w);
      at[r] = inside ? at_in[r] + (dy * p.w + dx) : kOutside;
    }
    int tap = (p.first[a] + j * p.tap_step) * p.kernel + p.first[b] + k * p.tap_step;
    int block = begin + tap * p.in4 * 8;
    if (kIn4 > 0) {
      [[unroll]] for (int c = 0; c < kIn4; ++c) add_channels(at, c * p.h * p.w, block + c * 8, block_stride);
    } else {
      for (int c = 0; c < p.in4; ++c) add_channels(at, c * p.h * p.w, block + c * 8, block_stride);
    }
    ++k;
    j = k == p.taps[b] ? j + 1 : j;
    k = k == p.taps[b] ? 0 : k;
  }
}

void store_sums(int a, int b, int out_block) {
  int size = p.out_h * p.out_w;
  int at[kPixels];
  [[unroll]] for (int r = 0; r < kPixels; ++r)
    at[r] = (image[r] * p.out4 + out_block) * size + (row[r] * p.phases + a) * p.out_w + column[r] * p.phases + b;
  [[unroll]] for (int o = 0; o < kOut4; ++o)
    if (out_block + o < p.out4)
      [[unroll]] for (int r = 0; r < kPixels; ++r)
        if (image[r] < p.n) add4(y, at[r] + o * size, kExact != 0 ? sums[r][o] + lost[r][o] : sums[r][o], kAccumulate)
}

#ifdef TEXEL
// The same for one phase, where an image's pixels are a multiple of a subgroup's lanes.
void store_rows(int out_block) {
  int size = p.out_h * p.out_w;
  int first_image = known_uniform6(image[0]);
  int first_pixel = known_uniform8(row[0] * p.out_w + column[0] - int(gl_LocalInvocationID.x));
  int first_block = known_uniform4(out_block);
  [[unroll]] for (int r = 0; r < kPixels; ++r) {
    int pixel = first_pixel + r * int(gl_WorkGroupSize.x);
    int images_on = int((float(pixel) + 0.5) / float(size));
    int from = ((first_image + images_on) * p.out4 + first_block) * size + pixel - images_on * size;
    [[unroll]] for (int o = 0; o < kOut4; ++o)
      store4_row(y, first_block + o < p.out4 && first_image + images_on < p.n, from + o * size,
                 kExact != 0 ? sums[r][o] + lost[r][o] : sums[r][o])
  }
}
#endif

void main() {
#ifdef TEXEL
  if (kRows) ALIGN_SPILLS(y)
#endif
  int a = int(gl_WorkGroupID.z) / p.phases;
  int b = int(gl_WorkGroupID.z) - a * p.phases;
  int rows = (p.out_h - a + p.phases - 1) / p.phases;
  int columns = (p.out_w - b + p.phases - 1) / p.phases;
  int group = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x);
  int tile = group / p.tiles;
  int out_block = (group - tile * p.tiles) * kOut4;
  if (!kRows && tile * int(gl_WorkGroupSize.x) * kPixels >= p.n * rows * columns) return;
  find_pixels(tile, rows, columns);
  [[unroll]] for (int o = 0; o < kOut4; ++o) {
    vec4 start = load4(weights, p.bias + out_block + o);
    [[unroll]] for (int r = 0; r < kPixels; ++r) {
      sums[r][o] = start;
      lost[r][o] = vec4(0);
    }
  }
  add_taps(a, b, out_block);
#ifdef TEXEL
  if (kRows) {
    store_rows(out_block);
    return;
  }
#endif
  store_sums(a, b, out_block);
}
