// variants: f2 f4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row_store.glsl"
#include "winograd.glsl"
#include "winograd_tiles.glsl"

// V = B^T x B of every tile of an NC4HW4 tensor, zero outside the image and beyond the last tile.
READ4(0, x)
WRITE4(1, transformed)

void main() {
  ALIGN_SPILLS(transformed)
  Tile tile = find_tile();
  int y0 = tile.row * kMade + p.offset;
  int x0 = tile.column * kMade + p.offset;
  int plane = (tile.image * p.channels4 + int(gl_WorkGroupID.x)) * p.h;
  vec4 rows[kRead][kRead];
  [[unroll]] for (int i = 0; i < kRead; ++i) {
    bool inside = tile.image < p.images && uint(y0 + i) < uint(p.h);
    int at = inside ? (plane + y0 + i) * p.w + x0 : kOutside;
    vec4 line[kRead];
    [[unroll]] for (int j = 0; j < kRead; ++j) {
      int place = uint(x0 + j) < uint(p.w) ? at + j : kOutside;
      line[j] = load4_or_zero(x, place >= 0, place);
    }
    rows[i] = input_transform(line);
  }
  int to = first_frequency(known_block(), known_vector(), known_first_of_group());
  int step_ = frequency_step();
  [[unroll]] for (int j = 0; j < kRead; ++j) {
    vec4 line[kRead];
    [[unroll]] for (int i = 0; i < kRead; ++i) line[i] = rows[i][j];
    line = input_transform(line);
    [[unroll]] for (int i = 0; i < kRead; ++i) store4_row(transformed, true, to + (i * kRead + j) * step_, line[i])
  }
}
