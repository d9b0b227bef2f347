#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#extension GL_KHR_cooperative_matrix : require
#extension GL_KHR_memory_scope_semantics : require
#extension GL_KHR_shader_subgroup_basic : require
#include "access.glsl"

// A convolution, forward or transposed, as an implicit product of matrices that subgroups do together: pixels × input channels in float16
// times input channels × output channels in float16, added in float32. Phases and taps are those of conv_product.comp. Any sizes.
//
// A workgroup makes a tile of pixels × output channels, slab by slab, as conv_shared.comp does: a slab is kDepth matrices of input
// channels of one tap, and lies in shared memory as [pixel][input channel] and [output channel][input channel], in vectors of 8
// channels. An odd number of vectors to a row keeps neighbouring rows on different banks. A subgroup makes kRows × kColumns matrices.
// They go to memory through shared memory, for nobody knows which invocation holds which element.
//
// Operands that hold float16 are taken as they lie; float32 is rounded. weights as conv_cooperative_pack leaves them:
// [tap][in / 8][out][8 input channels], out rounded up to a multiple of 4.
layout(constant_id = 1) const int kM = 16;  // of a matrix: pixels,
layout(constant_id = 2) const int kN = 16;  // output channels
layout(constant_id = 3) const int kK = 16;  // and input channels
layout(constant_id = 4) const int kRows = 2;     // matrices of a subgroup across pixels
layout(constant_id = 5) const int kColumns = 2;  // and across output channels
layout(constant_id = 6) const int kDown = 2;     // subgroups across pixels
layout(constant_id = 7) const int kAcross = 2;   // and across output channels; the workgroup has kDown · kAcross
layout(constant_id = 8) const int kDepth = 2;
layout(constant_id = 101) const int kSubgroupSize = 32;

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
  int biases;  // output channels that have one: all or none
  uint accumulate;
} p;

READ4(0, x)
READ4(1, weights)
READ1(2, bias)
WRITE4(3, y)

const int kInvocations = kSubgroupSize * kDown * kAcross;
const int kTilePixels = kDown * kRows * kM;
const int kTileChannels = kAcross * kColumns * kN;
const int kDepth8 = kDepth * kK / 8;
const int kRow8 = kDepth8 | 1;  // vectors from row to row
const int kInputs = kTilePixels * kRow8;
const int kWeights = kTileChannels * kRow8;
// What one invocation fetches: sizes are powers of 2, so that every fetch of it belongs to one of kLoadPixels pixels.
const int kInputLoads = (kTilePixels * kDepth8 + kInvocations - 1) / kInvocations;
const int kWeightLoads = (kTileChannels * kDepth8 + kInvocations - 1) / kInvocations;
const int kLoadPixels = (kTilePixels + kInvocations - 1) / kInvocations;
const int kResultRow4 = (kN / 4) | 1;

shared uvec4 slab_inputs[2 * kInputs];
shared uvec4 slab_weights[2 * kWeights];
shared vec4 results[kDown * kAcross * kM * kResultRow4];  // a matrix of each subgroup
shared int out_at[kTilePixels];                          // where a pixel's first vector lies in y; -1: no such pixel

const int kOutside = -1073741824;

// The slab to fetch next: tap (j, k) of the phase and its first vector of 8 input channels. The same in all invocations.
int j = 0, k = 0, channel8 = 0;

// Where the tap at offset (0, 0) reads, for each pixel that this invocation fetches.
int yi[kLoadPixels], xi[kLoadPixels], at_in[kLoadPixels];

uvec4 next_inputs[kInputLoads];
uvec4 next_weights[kWeightLoads];

void find_pixels(int first_pixel, int a, int b) {
  int rows = (p.out_h - a + p.phases - 1) / p.phases;
  int columns = (p.out_w - b + p.phases - 1) / p.phases;
  [[unroll]] for (int q = 0; q < kLoadPixels; ++q) {
    int own = int(gl_LocalInvocationID.x) + q * kInvocations;
    int number = first_pixel + own % kTilePixels;
    int line = number / columns;
    int column = number - line * columns;
    int image = line / rows;
    int row = line - image * rows;
    bool is_some = image < p.n;
    yi[q] = is_some ? row * p.stride : kOutside;
    xi[q] = column * p.stride;
    at_in[q] = (image * p.in4 * p.h + row * p.stride) * p.w + xi[q];
    if (own < kTilePixels)
      out_at[own] = is_some ? (image * p.out4 * p.out_h + row * p.phases + a) * p.out_w + column * p.phases + b : -1;
  }
}

void fetch_slab(int a, int b, int first_channel) {
  int t = int(gl_LocalInvocationID.x);
  int dy = p.base[a] + j * p.step;
  int dx = p.base[b] + k * p.step;
  int tap = (p.first[a] + j * p.tap_step) * p.kernel + p.first[b] + k * p.tap_step;
  int in8 = (p.in4 + 1) / 2;
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int q = l % kLoadPixels;
    int c = 2 * (channel8 + (t + l * kInvocations) / kTilePixels);
    bool inside = uint(yi[q] + dy) < uint(p.h) && uint(xi[q] + dx) < uint(p.w);
    int at = at_in[q] + (c * p.h + dy) * p.w + dx;
    next_inputs[l].xy = words4_or_zero(x, inside && c < p.in4, at);
    next_inputs[l].zw = words4_or_zero(x, inside && c + 1 < p.in4, at + p.h * p.w);
  }
  [[unroll]] for (int l = 0; l < kWeightLoads; ++l) {
    int e = t + l * kInvocations;
    int c = channel8 + e / kTileChannels;
    int o = first_channel + e % kTileChannels;
    int at = 2 * ((tap * in8 + c) * 4 * p.out4 + o);
    bool inside = c < in8 && o < 4 * p.out4;
    next_weights[l].xy = words4_or_zero(weights, inside, at);
    next_weights[l].zw = words4_or_zero(weights, inside, at + 1);
  }
  channel8 += kDepth8;
  if (channel8 >= in8) {
    channel8 = 0;
    ++k;
    if (k == p.taps[b]) {
      k = 0;
      ++j;
    }
  }
}

void keep_slab(int half_) {
  int t = int(gl_LocalInvocationID.x);
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int e = t + l * kInvocations;
    if (e < kTilePixels * kDepth8) slab_inputs[half_ * kInputs + e % kTilePixels * kRow8 + e / kTilePixels] = next_inputs[l];
  }
  [[unroll]] for (int l = 0; l < kWeightLoads; ++l) {
    int e = t + l * kInvocations;
    if (e < kTileChannels * kDepth8) slab_weights[half_ * kWeights + e % kTileChannels * kRow8 + e / kTileChannels] = next_weights[l];
  }
}

coopmat<float, gl_ScopeSubgroup, kM, kN, gl_MatrixUseAccumulator> sums[kRows * kColumns];

void multiply_slab(int half_, int down, int across) {
  [[unroll]] for (int d = 0; d < kDepth; ++d) {
    coopmat<float16_t, gl_ScopeSubgroup, kM, kK, gl_MatrixUseA> v[kRows];
    [[unroll]] for (int r = 0; r < kRows; ++r)
      coopMatLoad(v[r], slab_inputs, half_ * kInputs + (down * kRows + r) * kM * kRow8 + d * kK / 8, kRow8,
                  gl_CooperativeMatrixLayoutRowMajor);
    [[unroll]] for (int c = 0; c < kColumns; ++c) {
      coopmat<float16_t, gl_ScopeSubgroup, kK, kN, gl_MatrixUseB> m;
      coopMatLoad(m, slab_weights, half_ * kWeights + (across * kColumns + c) * kN * kRow8 + d * kK / 8, kRow8,
                  gl_CooperativeMatrixLayoutColumnMajor);
      [[unroll]] for (int r = 0; r < kRows; ++r) sums[r * kColumns + c] = coopMatMulAdd(v[r], m, sums[r * kColumns + c]);
    }
  }
}

// Bias of 4 output channels.
vec4 bias_of(int o) {
  return vec4(load1_or_zero(bias, o < p.biases, o), load1_or_zero(bias, o + 1 < p.biases, o + 1),
              load1_or_zero(bias, o + 2 < p.biases, o + 2), load1_or_zero(bias, o + 3 < p.biases, o + 3));
}

// The matrix that the subgroup has put into `results`: first_pixel within the tile.
void write_matrix(int own, int first_pixel, int first_channel) {
  for (int e = int(gl_SubgroupInvocationID); e < kM * kN / 4; e += kSubgroupSize) {
    int at = out_at[first_pixel + e % kM];
    int o4 = first_channel / 4 + e / kM;
    if (at >= 0 && o4 < p.out4)
      add4(y, at + o4 * p.out_h * p.out_w, results[own + e % kM * kResultRow4 + e / kM] + bias_of(4 * o4), p.accumulate)
  }
}

void main() {
  int a = int(gl_WorkGroupID.z) / p.phases;
  int b = int(gl_WorkGroupID.z) - a * p.phases;
  int group = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x);
  int tile = group / p.tiles;
  int first_channel = (group - tile * p.tiles) * kTileChannels;
  int first_pixel = tile * kTilePixels;
  int pixels = p.n * ((p.out_h - a + p.phases - 1) / p.phases) * ((p.out_w - b + p.phases - 1) / p.phases);
  if (first_pixel >= pixels) return;  // all of the workgroup
  int subgroup = int(gl_SubgroupID);
  int down = subgroup % kDown;
  int across = subgroup / kDown;

  find_pixels(first_pixel, a, b);
  [[unroll]] for (int i = 0; i < kRows * kColumns; ++i)
    sums[i] = coopmat<float, gl_ScopeSubgroup, kM, kN, gl_MatrixUseAccumulator>(0.0);
  int slabs = p.taps[a] * p.taps[b] * (((p.in4 + 1) / 2 + kDepth8 - 1) / kDepth8);
  if (slabs > 0) {
    fetch_slab(a, b, first_channel);
    keep_slab(0);
  }
  barrier();
  for (int s = 0; s < slabs; ++s) {
    bool more = s + 1 < slabs;
    if (more) fetch_slab(a, b, first_channel);
    multiply_slab(s & 1, down, across);
    if (more) keep_slab((s + 1) & 1);
    barrier();
  }

  int own = subgroup * kM * kResultRow4;
  [[unroll]] for (int r = 0; r < kRows; ++r)
    [[unroll]] for (int c = 0; c < kColumns; ++c) {
      coopMatStore(sums[r * kColumns + c], results, own, kResultRow4, gl_CooperativeMatrixLayoutRowMajor);
      barrier();
      write_matrix(own, (down * kRows + r) * kM, first_channel + (across * kColumns + c) * kN);
      barrier();
    }
}
