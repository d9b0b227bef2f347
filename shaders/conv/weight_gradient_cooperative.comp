#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#extension GL_KHR_cooperative_matrix : require
#extension GL_KHR_memory_scope_semantics : require
#extension GL_KHR_shader_subgroup_basic : require
#include "access.glsl"

// partial[strip][co][tap][ci / 4] = sum over the strip's pixels of dy[n][co][yo][xo] x[n][ci][yo stride + ky dilation - padding][...],
// as weight_gradient_shared.comp has it, by matrices that subgroups multiply together: rows are output channels, columns are taps times
// input channels, and the sum runs over gradient pixels, in float32. Operands that hold float16 are taken as they lie; float32 is
// rounded. Any shape.
//
// A workgroup makes a tile of rows and columns for one strip of pixels, slab by slab: a slab is kDepth matrices of pixels, and lies in
// shared memory as [pixel][row] and [pixel][column], in vectors of 8. An odd number of vectors to a pixel keeps neighbouring pixels on
// different banks. A subgroup makes kRows × kColumns matrices, which go to memory through shared memory.
layout(constant_id = 1) const int kM = 16;  // of a matrix: output channels,
layout(constant_id = 2) const int kN = 16;  // input channels of taps
layout(constant_id = 3) const int kK = 16;  // and pixels
layout(constant_id = 4) const int kRows = 2;     // matrices of a subgroup across rows
layout(constant_id = 5) const int kColumns = 2;  // and across columns
layout(constant_id = 6) const int kDown = 2;     // subgroups across rows
layout(constant_id = 7) const int kAcross = 2;   // and across columns; the workgroup has kDown · kAcross
layout(constant_id = 8) const int kDepth = 2;    // kDepth · kK divides the workgroup
layout(constant_id = 101) const int kSubgroupSize = 32;

layout(push_constant) uniform Push {
  int n;
  int ci4;
  int h;
  int w;
  int co4;
  int ho;
  int wo;
  int kernel;
  int stride;
  int padding;
  int dilation;
  int strip_pixels;
  int step_rows;     // a slab's pixels on: images, rows and columns
  int step_columns;
  int step_images;
} p;

READ4(0, x)
READ4(1, dy)
WRITE4(2, partial)

const int kInvocations = kSubgroupSize * kDown * kAcross;
const int kPixels = kDepth * kK;  // of a slab
const int kTileRows8 = kDown * kRows * kM / 8;
const int kTileColumns8 = kAcross * kColumns * kN / 8;
const int kRow8 = kTileRows8 | 1;  // vectors from pixel to pixel
const int kColumn8 = kTileColumns8 | 1;
const int kStep = kInvocations / kPixels;  // an invocation fetches one pixel of every kStep-th vector of channels
const int kGradientLoads = (kTileRows8 + kStep - 1) / kStep;
const int kInputLoads = (kTileColumns8 + kStep - 1) / kStep;
const int kResultRow4 = (kN / 4) | 1;

shared uvec4 slab_gradients[2 * kPixels * kRow8];
shared uvec4 slab_inputs[2 * kPixels * kColumn8];
shared vec4 results[kDown * kAcross * kM * kResultRow4];  // a matrix of each subgroup

// The pixel that this invocation fetches next, and how many of the strip are left from it on.
int image, row, column, left;

// Of each vector of 4 columns that this invocation fetches, two to a vector of 8: offset of its tap, and first vector of its channels;
// below 0 where there is none.
int tap_y[2 * kInputLoads], tap_x[2 * kInputLoads], plane[2 * kInputLoads];

uvec4 next_gradients[kGradientLoads];
uvec4 next_inputs[kInputLoads];

void find_columns(int first_column8, int own) {
  [[unroll]] for (int l = 0; l < 2 * kInputLoads; ++l) {
    int c4 = 2 * (first_column8 + own + l / 2 * kStep) + l % 2;
    int tap = c4 / p.ci4;
    int ky = tap / p.kernel;
    tap_y[l] = ky * p.dilation - p.padding;
    tap_x[l] = (tap - ky * p.kernel) * p.dilation - p.padding;
    plane[l] = tap < p.kernel * p.kernel ? c4 - tap * p.ci4 : -1;
  }
}

uvec2 gradient(int r4) {
  return words4_or_zero(dy, left > 0 && r4 < p.co4, ((image * p.co4 + r4) * p.ho + row) * p.wo + column);
}

uvec2 input_of(int l) {
  int yi = row * p.stride + tap_y[l];
  int xi = column * p.stride + tap_x[l];
  bool inside = left > 0 && plane[l] >= 0 && uint(yi) < uint(p.h) && uint(xi) < uint(p.w);
  return words4_or_zero(x, inside, ((image * p.ci4 + plane[l]) * p.h + yi) * p.w + xi);
}

void fetch_slab(int first_row8, int own) {
  [[unroll]] for (int l = 0; l < kGradientLoads; ++l) {
    int r8 = first_row8 + own + l * kStep;
    next_gradients[l] = uvec4(gradient(2 * r8), gradient(2 * r8 + 1));
  }
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) next_inputs[l] = uvec4(input_of(2 * l), input_of(2 * l + 1));
  left -= kPixels;
  column += p.step_columns;
  int carry = column >= p.wo ? 1 : 0;
  column -= carry * p.wo;
  row += p.step_rows + carry;
  carry = row >= p.ho ? 1 : 0;
  row -= carry * p.ho;
  image += p.step_images + carry;
}

void keep_slab(int half_, int pixel, int own) {
  [[unroll]] for (int l = 0; l < kGradientLoads; ++l) {
    int r8 = own + l * kStep;
    if (r8 < kTileRows8) slab_gradients[(half_ * kPixels + pixel) * kRow8 + r8] = next_gradients[l];
  }
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int c8 = own + l * kStep;
    if (c8 < kTileColumns8) slab_inputs[(half_ * kPixels + pixel) * kColumn8 + c8] = next_inputs[l];
  }
}

coopmat<float, gl_ScopeSubgroup, kM, kN, gl_MatrixUseAccumulator> sums[kRows * kColumns];

void multiply_slab(int half_, int down, int across) {
  [[unroll]] for (int d = 0; d < kDepth; ++d) {
    int pixel = half_ * kPixels + d * kK;
    coopmat<float16_t, gl_ScopeSubgroup, kM, kK, gl_MatrixUseA> g[kRows];
    [[unroll]] for (int r = 0; r < kRows; ++r)
      coopMatLoad(g[r], slab_gradients, pixel * kRow8 + (down * kRows + r) * kM / 8, kRow8, gl_CooperativeMatrixLayoutColumnMajor);
    [[unroll]] for (int c = 0; c < kColumns; ++c) {
      coopmat<float16_t, gl_ScopeSubgroup, kK, kN, gl_MatrixUseB> v;
      coopMatLoad(v, slab_inputs, pixel * kColumn8 + (across * kColumns + c) * kN / 8, kColumn8, gl_CooperativeMatrixLayoutRowMajor);
      [[unroll]] for (int r = 0; r < kRows; ++r) sums[r * kColumns + c] = coopMatMulAdd(g[r], v, sums[r * kColumns + c]);
    }
  }
}

// The matrix that the subgroup has put into `results`.
void write_matrix(int own, int strip, int first_row, int first_column) {
  int columns4 = p.kernel * p.kernel * p.ci4;
  for (int e = int(gl_SubgroupInvocationID); e < kM * kN / 4; e += kSubgroupSize) {
    int r = first_row + e / (kN / 4);
    int c4 = first_column / 4 + e % (kN / 4);
    if (r < 4 * p.co4 && c4 < columns4)
      store4(partial, (strip * p.co4 * 4 + r) * columns4 + c4, results[own + e / (kN / 4) * kResultRow4 + e % (kN / 4)])
  }
}

void main() {
  int t = int(gl_LocalInvocationID.x);
  int subgroup = int(gl_SubgroupID);
  int down = subgroup % kDown;
  int across = subgroup / kDown;
  int pixel = t % kPixels;  // neighbours fetch neighbouring pixels
  int own = t / kPixels;
  int first_column8 = int(gl_WorkGroupID.x) * kTileColumns8;
  int first_row8 = int(gl_WorkGroupID.y) * kTileRows8;
  int strip = int(gl_WorkGroupID.z);
  int begin = strip * p.strip_pixels;
  int pixels = min(p.strip_pixels, p.n * p.ho * p.wo - begin);

  int line = (begin + pixel) / p.wo;
  column = begin + pixel - line * p.wo;
  image = line / p.ho;
  row = line - image * p.ho;
  left = pixels - pixel;
  find_columns(first_column8, own);
  [[unroll]] for (int i = 0; i < kRows * kColumns; ++i)
    sums[i] = coopmat<float, gl_ScopeSubgroup, kM, kN, gl_MatrixUseAccumulator>(0.0);

  int slabs = (pixels + kPixels - 1) / kPixels;
  fetch_slab(first_row8, own);
  keep_slab(0, pixel, own);
  barrier();
  for (int s = 0; s < slabs; ++s) {
    bool more = s + 1 < slabs;
    if (more) fetch_slab(first_row8, own);
    multiply_slab(s & 1, down, across);
    if (more) keep_slab((s + 1) & 1, pixel, own);
    barrier();
  }

  int result = subgroup * kM * kResultRow4;
  [[unroll]] for (int r = 0; r < kRows; ++r)
    [[unroll]] for (int c = 0; c < kColumns; ++c) {
      coopMatStore(sums[r * kColumns + c], results, result, kResultRow4, gl_CooperativeMatrixLayoutRowMajor);
      barrier();
      write_matrix(result, strip, 8 * first_row8 + (down * kRows + r) * kM, 8 * first_column8 + (across * kColumns + c) * kN);
      barrier();
    }
}
