#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "product_remainder.glsl"

// A convolution, forward or transposed, as an implicit product of matrices through shared memory: the sums, phases and taps of
// conv_product.comp, in the same order, for GPUs. Any sizes; nothing here depends on the size of a subgroup.
//
// A workgroup makes a tile of output channels and pixels, slab by slab: a slab is kDepth vectors of 4 input channels of one tap. While a
// slab is multiplied, the next one is on its way from memory to registers; it goes to the other half of the shared arrays, so that one
// barrier a slab is enough. An invocation makes kPixels pixels, kAcross apart, of kOut4 vectors of 4 output channels, kDown apart:
// neighbours then read neighbouring vectors of 16 bytes (pixels) or one and the same (weights), neither of which makes bank conflicts,
// and so does the store to the shared arrays; they need no padding. Pixels of a phase are numbered through images and rows.
//
// weights as conv_shared_pack leaves them: [tap][in][out / 4], a vec4 of 4 output channels; then bias[out / 4].
layout(constant_id = 1) const int kOut4 = 2;
layout(constant_id = 2) const int kPixels = 4;
layout(constant_id = 3) const int kAcross = 16;  // invocations across pixels
layout(constant_id = 4) const int kDown = 4;     // and across output channels; the workgroup has kAcross · kDown
layout(constant_id = 5) const int kDepth = 2;
layout(constant_id = 6) const uint kExact = 0;  // 1: what sums and products round off is kept and added at the end

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
  uint accumulate;
} p;

READ4(0, x)
READ4(1, weights)
WRITE4(2, y)

const int kInvocations = kAcross * kDown;
const int kTilePixels = kAcross * kPixels;
const int kTileOut4 = kDown * kOut4;
const int kInputs = kDepth * kTilePixels;      // vectors of a slab, [in4][pixel], each of 4 input channels
const int kWeights = 4 * kDepth * kTileOut4;   // and [in][out4], each of 4 output channels
// What one invocation fetches: sizes are powers of 2, so that every fetch of it belongs to one of kLoadPixels pixels.
const int kInputLoads = (kInputs + kInvocations - 1) / kInvocations;
const int kWeightLoads = (kWeights + kInvocations - 1) / kInvocations;
const int kLoadPixels = (kTilePixels + kInvocations - 1) / kInvocations;

shared vec4 slab_inputs[2 * kInputs];
shared vec4 slab_weights[2 * kWeights];

const int kOutside = -1073741824;

struct Pixel {
  int image;  // beyond the last one where there is no such pixel
  int row;    // within the phase
  int column;
};

Pixel find_pixel(int number, int rows, int columns) {
  int line = number / columns;
  Pixel pixel;
  pixel.column = number - line * columns;
  pixel.image = line / rows;
  pixel.row = line - pixel.image * rows;
  return pixel;
}

// The slab to fetch next: tap (j, k) of the phase and its first vector of input channels. The same in all invocations.
int j = 0, k = 0, channel4 = 0;

// Where the tap at offset (0, 0) reads, for each pixel that this invocation fetches.
int yi[kLoadPixels], xi[kLoadPixels], at_in[kLoadPixels];

vec4 next_inputs[kInputLoads];
vec4 next_weights[kWeightLoads];

void fetch_slab(int a, int b, int first_out4) {
  int t = int(gl_LocalInvocationID.x);
  int dy = p.base[a] + j * p.step;
  int dx = p.base[b] + k * p.step;
  int tap = (p.first[a] + j * p.tap_step) * p.kernel + p.first[b] + k * p.tap_step;
  [[unroll]] for (int l = 0; l < kInputLoads; ++l) {
    int q = l % kLoadPixels;
    int c = channel4 + (t + l * kInvocations) / kTilePixels;
    bool inside = uint(yi[q] + dy) < uint(p.h) && uint(xi[q] + dx) < uint(p.w) && c < p.in4;
    next_inputs[l] = load4_or_zero(x, inside, at_in[q] + (c * p.h + dy) * p.w + dx);
  }
  [[unroll]] for (int l = 0; l < kWeightLoads; ++l) {
    int e = t + l * kInvocations;
    int i = 4 * channel4 + e / kTileOut4;
    int o = first_out4 + e % kTileOut4;
    next_weights[l] = load4_or_zero(weights, i < 4 * p.in4 && o < p.out4, (tap * 4 * p.in4 + i) * p.out4 + o);
  }
  channel4 += kDepth;
  if (channel4 >= p.in4) {
    channel4 = 0;
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
    if (kInputs % kInvocations == 0 || e < kInputs) slab_inputs[half_ * kInputs + e] = next_inputs[l];
  }
  [[unroll]] for (int l = 0; l < kWeightLoads; ++l) {
    int e = t + l * kInvocations;
    if (kWeights % kInvocations == 0 || e < kWeights) slab_weights[half_ * kWeights + e] = next_weights[l];
  }
}

vec4 sums[kPixels][kOut4];
vec4 lost[kPixels][kOut4];  // with kExact

// sums += s · v, and what that rounds off to `lost`: Knuth's two-sum, and the product's own remainder.
void add_exactly(int r, int o, float s, vec4 v) {
  precise vec4 term = s * v;
  precise vec4 before = sums[r][o];
  precise vec4 sum = before + term;
  precise vec4 added = sum - before;
  precise vec4 error = (before - (sum - added)) + (term - added);
  sums[r][o] = sum;
  lost[r][o] += error + product_remainder(vec4(s), v, term);
}

void multiply_slab(int half_, int across, int down) {
  [[unroll]] for (int d = 0; d < kDepth; ++d) {
    vec4 v[kPixels];
    [[unroll]] for (int r = 0; r < kPixels; ++r)
      v[r] = slab_inputs[half_ * kInputs + d * kTilePixels + across + r * kAcross];
    [[unroll]] for (int i = 0; i < 4; ++i)
      [[unroll]] for (int o = 0; o < kOut4; ++o) {
        vec4 w = slab_weights[half_ * kWeights + (4 * d + i) * kTileOut4 + down + o * kDown];
        [[unroll]] for (int r = 0; r < kPixels; ++r)
          if (kExact != 0)
            add_exactly(r, o, v[r][i], w);
          else
            sums[r][o] = fma(vec4(v[r][i]), w, sums[r][o]);
      }
  }
}

void main() {
  int a = int(gl_WorkGroupID.z) / p.phases;
  int b = int(gl_WorkGroupID.z) - a * p.phases;
  int rows = (p.out_h - a + p.phases - 1) / p.phases;
  int columns = (p.out_w - b + p.phases - 1) / p.phases;
  int group = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x);
  int tile = group / p.tiles;
  int first_out4 = (group - tile * p.tiles) * kTileOut4;
  int first_pixel = tile * kTilePixels;
  if (first_pixel >= p.n * rows * columns) return;  // all of the workgroup
  int across = int(gl_LocalInvocationID.x) % kAcross;
  int down = int(gl_LocalInvocationID.x) / kAcross;

  [[unroll]] for (int q = 0; q < kLoadPixels; ++q) {
    int within = (int(gl_LocalInvocationID.x) + q * kInvocations) % kTilePixels;
    Pixel pixel = find_pixel(first_pixel + within, rows, columns);
    yi[q] = pixel.image < p.n ? pixel.row * p.stride : kOutside;
    xi[q] = pixel.column * p.stride;
    at_in[q] = (pixel.image * p.in4 * p.h + pixel.row * p.stride) * p.w + xi[q];
  }
  [[unroll]] for (int o = 0; o < kOut4; ++o) {
    int at = first_out4 + down + o * kDown;
    vec4 start = load4_or_zero(weights, at < p.out4, p.bias + at);
    [[unroll]] for (int r = 0; r < kPixels; ++r) {
      sums[r][o] = start;
      lost[r][o] = vec4(0);
    }
  }

  int slabs = p.taps[a] * p.taps[b] * ((p.in4 + kDepth - 1) / kDepth);
  if (slabs > 0) {
    fetch_slab(a, b, first_out4);
    keep_slab(0);
  }
  barrier();
  for (int s = 0; s < slabs; ++s) {
    bool more = s + 1 < slabs;
    if (more) fetch_slab(a, b, first_out4);
    multiply_slab(s & 1, across, down);
    if (more) keep_slab((s + 1) & 1);
    barrier();
  }

  int size = p.out_h * p.out_w;
  [[unroll]] for (int r = 0; r < kPixels; ++r) {
    Pixel pixel = find_pixel(first_pixel + across + r * kAcross, rows, columns);
    if (pixel.image < p.n) {
      int at = pixel.image * p.out4 * size + (pixel.row * p.phases + a) * p.out_w + pixel.column * p.phases + b;
      [[unroll]] for (int o = 0; o < kOut4; ++o) {
        int out4 = first_out4 + down + o * kDown;
        if (out4 < p.out4)
          add4(y, at + out4 * size, kExact != 0 ? sums[r][o] + lost[r][o] : sums[r][o], p.accumulate)
      }
    }
  }
}
