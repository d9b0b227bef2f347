#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"

// partial[strip][co][tap][ci / 4] = sum over the strip's pixels of dy[n][co][yo][xo] x[n][ci][yo stride + ky dilation - padding][...],
// as a product of matrices through shared memory, for GPUs: rows are output channels, columns are taps times input channels, and the sum
// runs over gradient pixels, numbered through the batch. Any shape; nothing here depends on the size of a subgroup.
//
// A workgroup makes a tile of rows and columns for one strip of pixels, slab by slab: a slab is kDepth pixels. While one is multiplied,
// the next is on its way from memory to registers; it goes to the other half of the shared arrays, so that one barrier a slab is enough.
// An invocation sums kRows4 vectors of 4 rows, kDown apart, times kColumns4 vectors of 4 columns, kAcross apart. Invocations that
// fetch neighbouring pixels store them a whole row of the shared arrays apart: one more vector a row keeps those off the same banks.
layout(constant_id = 1) const int kRows4 = 2;
layout(constant_id = 2) const int kColumns4 = 2;
layout(constant_id = 3) const int kAcross = 8;  // invocations across columns
layout(constant_id = 4) const int kDown = 8;    // and across rows; the workgroup has kAcross · kDown
layout(constant_id = 5) const int kDepth = 8;   // divides the workgroup

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
  int step_rows;     // kDepth pixels on: images, rows and columns
  int step_columns;
  int step_images;
} p;

READ4(0, x)
READ4(1, dy)
WRITE4(2, partial)

const int kInvocations = kAcross * kDown;
const int kTileRows4 = kDown * kRows4;
const int kTileColumns4 = kAcross * kColumns4;
const int kGradients = kDepth * (kTileRows4 + 1);  // vectors of a slab, [pixel][row / 4]
const int kInputs = kDepth * (kTileColumns4 + 1);  // [pixel][column / 4]
const int kStep = kInvocations / kDepth;           // an invocation fetches one pixel of every kStep-th vector of channels
const int kGradientLoads = (kTileRows4 + kStep - 1) / kStep;
const int kInputLoads = (kTileColumns4 + kStep - 1) / kStep;

shared vec4 slab_gradients[2 * kGradients];
shared vec4 slab_inputs[2 * kInputs];

// The pixel that this invocation fetches next, and how many of the strip are left from it on.
int image, row, column, left;

// Of each column vector that this invocation fetches: offset of its tap, and first vector of its channels; below 0 where there is none.
int tap_y[kInputLoads], tap_x[kInputLoads], plane[kInputLoads];

vec4 next_gradients[kGradientLoads];
vec4 next_inputs[kInputLoads];

void find_columns(int first_column4, int own) {
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int c4 = first_column4 + own + l * kStep;
    int tap = c4 / p.ci4;
    int ky = tap / p.kernel;
    tap_y[l] = ky * p.dilation - p.padding;
    tap_x[l] = (tap - ky * p.kernel) * p.dilation - p.padding;
    plane[l] = tap < p.kernel * p.kernel ? c4 - tap * p.ci4 : -1;
  }
}

void fetch_slab(int first_row4, int own) {
  bool some = left > 0;
  int size = p.ho * p.wo;
  [[unroll]] for (int l = 0; l < kGradientLoads; ++l) {
    int r4 = first_row4 + own + l * kStep;
    next_gradients[l] = load4_or_zero(dy, some && r4 < p.co4, (image * p.co4 + r4) * size + row * p.wo + column);
  }
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int yi = row * p.stride + tap_y[l];
    int xi = column * p.stride + tap_x[l];
    bool inside = some && plane[l] >= 0 && uint(yi) < uint(p.h) && uint(xi) < uint(p.w);
    next_inputs[l] = load4_or_zero(x, inside, ((image * p.ci4 + plane[l]) * p.h + yi) * p.w + xi);
  }
  left -= kDepth;
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
    int r4 = own + l * kStep;
    if (kTileRows4 % kStep == 0 || r4 < kTileRows4)
      slab_gradients[half_ * kGradients + pixel * (kTileRows4 + 1) + r4] = next_gradients[l];
  }
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int c4 = own + l * kStep;
    if (kTileColumns4 % kStep == 0 || c4 < kTileColumns4)
      slab_inputs[half_ * kInputs + pixel * (kTileColumns4 + 1) + c4] = next_inputs[l];
  }
}

vec4 sums[kRows4][4][kColumns4];

void multiply_slab(int half_, int across, int down) {
  [[unroll]] for (int q = 0; q < kDepth; ++q) {
    vec4 g[kRows4], v[kColumns4];
    [[unroll]] for (int r = 0; r < kRows4; ++r)
      g[r] = slab_gradients[half_ * kGradients + q * (kTileRows4 + 1) + down + r * kDown];
    [[unroll]] for (int c = 0; c < kColumns4; ++c)
      v[c] = slab_inputs[half_ * kInputs + q * (kTileColumns4 + 1) + across + c * kAcross];
    [[unroll]] for (int r = 0; r < kRows4; ++r)
      [[unroll]] for (int i = 0; i < 4; ++i)
        [[unroll]] for (int c = 0; c < kColumns4; ++c)
          sums[r][i][c] = fma(vec4(g[r][i]), v[c], sums[r][i][c]);
  }
}

void main() {
  int t = int(gl_LocalInvocationID.x);
  int across = t % kAcross;
  int down = t / kAcross;
  int pixel = t % kDepth;  // neighbours fetch neighbouring pixels
  int own = t / kDepth;
  int first_column4 = int(gl_WorkGroupID.x) * kTileColumns4;
  int first_row4 = int(gl_WorkGroupID.y) * kTileRows4;
  int strip = int(gl_WorkGroupID.z);
  int begin = strip * p.strip_pixels;
  int pixels = min(p.strip_pixels, p.n * p.ho * p.wo - begin);

  int line = (begin + pixel) / p.wo;
  column = begin + pixel - line * p.wo;
  image = line / p.ho;
  row = line - image * p.ho;
  left = pixels - pixel;
  find_columns(first_column4, own);
  [[unroll]] for (int r = 0; r < kRows4; ++r)
    [[unroll]] for (int i = 0; i < 4; ++i)
      [[unroll]] for (int c = 0; c < kColumns4; ++c) sums[r][i][c] = vec4(0);

  int slabs = (pixels + kDepth - 1) / kDepth;
  fetch_slab(first_row4, own);
  keep_slab(0, pixel, own);
  barrier();
  for (int s = 0; s < slabs; ++s) {
    bool more = s + 1 < slabs;
    if (more) fetch_slab(first_row4, own);
    multiply_slab(s & 1, across, down);
    if (more) keep_slab((s + 1) & 1, pixel, own);
    barrier();
  }

  int columns4 = p.kernel * p.kernel * p.ci4;
  [[unroll]] for (int r = 0; r < kRows4; ++r) {
    int r4 = first_row4 + down + r * kDown;
    [[unroll]] for (int c = 0; c < kColumns4; ++c) {
      int c4 = first_column4 + across + c * kAcross;
      if (r4 < p.co4 && c4 < columns4)
        [[unroll]] for (int i = 0; i < 4; ++i)
          store4(partial, ((strip * p.co4 + r4) * 4 + i) * columns4 + c4, sums[r][i][c])
    }
  }
}
