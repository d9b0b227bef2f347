#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row4.glsl"

// out[row][column] (+)= bias[column] + sum over terms of a[row][term] b[term][column], through shared memory, for GPUs: y = x wᵀ + b
// and its gradients of x and w. Matrices are row-major and dense, from an offset in elements on. `a` lies as (rows, terms) or, where
// kA is not kTermsInside, transposed as (terms, rows); `b` as (columns, terms) or (terms, columns). Any sizes; nothing here depends on
// the size of a subgroup.
//
// A workgroup makes a tile of rows and columns, slab by slab: a slab is kDepth terms. While one is multiplied, the next is on its way
// from memory to registers; it goes to the other half of the shared arrays, so that one barrier a slab is enough. An invocation sums
// kRows4 vectors of 4 rows, kDown apart, times kColumns4 vectors of 4 columns, kAcross apart. Neighbours fetch what lies side by side.
// If those are terms, they store them a whole row of the shared array apart, and one more vector a row keeps them off the same banks.
//
// Terms are added one by one in runs of kRun, as linear_forward.comp and the others do.
layout(constant_id = 1) const uint kRows4 = 1;
layout(constant_id = 2) const uint kColumns4 = 1;
layout(constant_id = 3) const uint kAcross = 8;  // invocations across columns
layout(constant_id = 4) const uint kDown = 8;    // and across rows; the workgroup has kAcross · kDown
layout(constant_id = 5) const uint kDepth = 8;   // divides kRun
layout(constant_id = 6) const uint kA = 0;
layout(constant_id = 7) const uint kB = 0;
layout(constant_id = 8) const uint kVectors = 0;  // of `out`
layout(constant_id = 9) const uint kBias = 0;

// How an operand lies and is read.
const uint kTermsInside = 0;   // single elements, of which neighbouring ones are neighbouring terms
const uint kTermsOutside = 1;  // single elements, neighbouring ones being rows (or columns)
const uint kTermsOutsideInVectors = 2;

layout(push_constant) uniform Push {
  uint rows;
  uint columns;
  uint terms;
  uint a_offset;
  uint b_offset;
  uint out_offset;
  uint accumulate;
} p;

READ4(0, a4)
READ1(1, a1)
READ4(2, b4)
READ1(3, b1)
READ1(4, bias)
WRITE4(5, out4)
WRITE1(6, out1)

const uint kRun = 256;
const uint kInvocations = kAcross * kDown;
const uint kTileRows4 = kDown * kRows4;
const uint kTileColumns4 = kAcross * kColumns4;
const uint kALoads = (kDepth * kTileRows4 + kInvocations - 1) / kInvocations;
const uint kBLoads = (kDepth * kTileColumns4 + kInvocations - 1) / kInvocations;
const uint kARow = kTileRows4 + 1;
const uint kBRow = kTileColumns4 + 1;

shared vec4 slab_a[2 * kDepth * kARow];  // [term][row / 4]
shared vec4 slab_b[2 * kDepth * kBRow];  // [term][column / 4]

vec4 next_a[kALoads];
vec4 next_b[kBLoads];

// Element e of a slab of `tile4` vectors a term: its term and its vector.
uvec2 place(uint e, uint how, uint tile4) {
  return how == kTermsInside ? uvec2(e % kDepth, e / kDepth) : uvec2(e / tile4, e % tile4);
}

// Lines i … i + 3 of an operand of `count` lines (rows of a, columns of b) at one term.
#define fetch4(name, how, at, term, i, count) \
  ((how) == kTermsOutsideInVectors ? load4_or_zero(name##4, (term) < p.terms && (i) < (count), ((at) + (term) * (count) + (i)) >> 2) \
   : (how) == kTermsOutside        ? singles4(name##1, (term) < p.terms, (at) + (term) * (count) + (i), 1, i, count) \
                                   : singles4(name##1, (term) < p.terms, (at) + (i) * p.terms + (term), p.terms, i, count))

void fetch_slab(uint first_row, uint first_column, uint first_term) {
  uint t = gl_LocalInvocationID.x;
  [[unroll]] for (uint l = 0; l < kALoads; ++l) {
    uvec2 at = place(t + l * kInvocations, kA, kTileRows4);
    uint term = first_term + at.x, row = first_row + 4 * at.y;
    next_a[l] = fetch4(a, kA, p.a_offset, term, row, p.rows);
  }
  [[unroll]] for (uint l = 0; l < kBLoads; ++l) {
    uvec2 at = place(t + l * kInvocations, kB, kTileColumns4);
    uint term = first_term + at.x, column = first_column + 4 * at.y;
    next_b[l] = fetch4(b, kB, p.b_offset, term, column, p.columns);
  }
}

void keep_slab(uint half_) {
  uint t = gl_LocalInvocationID.x;
  [[unroll]] for (uint l = 0; l < kALoads; ++l) {
    uint e = t + l * kInvocations;
    uvec2 at = place(e, kA, kTileRows4);
    if (kDepth * kTileRows4 % kInvocations == 0 || e < kDepth * kTileRows4)
      slab_a[(half_ * kDepth + at.x) * kARow + at.y] = next_a[l];
  }
  [[unroll]] for (uint l = 0; l < kBLoads; ++l) {
    uint e = t + l * kInvocations;
    uvec2 at = place(e, kB, kTileColumns4);
    if (kDepth * kTileColumns4 % kInvocations == 0 || e < kDepth * kTileColumns4)
      slab_b[(half_ * kDepth + at.x) * kBRow + at.y] = next_b[l];
  }
}

vec4 sums[kRows4][4][kColumns4];
vec4 totals[kRows4][4][kColumns4];

void multiply_slab(uint half_, uint across, uint down) {
  [[unroll]] for (uint d = 0; d < kDepth; ++d) {
    vec4 v[kRows4], w[kColumns4];
    [[unroll]] for (uint r = 0; r < kRows4; ++r) v[r] = slab_a[(half_ * kDepth + d) * kARow + down + r * kDown];
    [[unroll]] for (uint c = 0; c < kColumns4; ++c) w[c] = slab_b[(half_ * kDepth + d) * kBRow + across + c * kAcross];
    [[unroll]] for (uint r = 0; r < kRows4; ++r)
      [[unroll]] for (uint i = 0; i < 4; ++i)
        [[unroll]] for (uint c = 0; c < kColumns4; ++c) sums[r][i][c] = fma(vec4(v[r][i]), w[c], sums[r][i][c]);
  }
}

void end_run() {
  [[unroll]] for (uint r = 0; r < kRows4; ++r)
    [[unroll]] for (uint i = 0; i < 4; ++i)
      [[unroll]] for (uint c = 0; c < kColumns4; ++c) {
        totals[r][i][c] += sums[r][i][c];
        sums[r][i][c] = vec4(0);
      }
}

void main() {
  uint across = gl_LocalInvocationID.x % kAcross;
  uint down = gl_LocalInvocationID.x / kAcross;
  uint first_column = gl_WorkGroupID.x * 4 * kTileColumns4;
  uint first_row = gl_WorkGroupID.y * 4 * kTileRows4;
  [[unroll]] for (uint r = 0; r < kRows4; ++r)
    [[unroll]] for (uint i = 0; i < 4; ++i)
      [[unroll]] for (uint c = 0; c < kColumns4; ++c) {
        sums[r][i][c] = vec4(0);
        totals[r][i][c] = vec4(0);
      }

  uint slabs = (p.terms + kDepth - 1) / kDepth;
  fetch_slab(first_row, first_column, 0);
  keep_slab(0);
  barrier();
  for (uint s = 0; s < slabs; ++s) {
    bool more = s + 1 < slabs;
    if (more) fetch_slab(first_row, first_column, (s + 1) * kDepth);
    multiply_slab(s & 1, across, down);
    if ((s + 1) * kDepth % kRun == 0) end_run();
    if (more) keep_slab((s + 1) & 1);
    barrier();
  }
  end_run();

  [[unroll]] for (uint c = 0; c < kColumns4; ++c) {
    uint column = first_column + 4 * (across + c * kAcross);
    if (column < p.columns) {
      vec4 start = kBias != 0 ? singles4(bias, true, column, 1, column, p.columns) : vec4(0);
      [[unroll]] for (uint r = 0; r < kRows4; ++r)
        [[unroll]] for (uint i = 0; i < 4; ++i) {
          uint row = first_row + 4 * (down + r * kDown) + i;
          if (row < p.rows)
            add_row4(out, kVectors, p.out_offset + row * p.columns, column, p.columns, totals[r][i][c] + start, p.accumulate)
        }
    }
  }
}
