// variants: f2 f4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row_store.glsl"
#include "winograd.glsl"
#include "winograd_tiles.glsl"

// D = A dy A^T of every tile of an NC4HW4 gradient, for the weight gradient: the transpose of what winograd_output does. Zero beyond
// the last tile.
READ4(0, dy)
WRITE4(1, transformed)

void main() {
  ALIGN_SPILLS(transformed)
  Tile tile = find_tile();
  int y0 = tile.row * kMade;
  int x0 = tile.column * kMade;
  int plane = (tile.image * p.channels4 + int(gl_WorkGroupID.x)) * p.h;
  vec4 rows[kMade][kRead];
  [[unroll]] for (int i = 0; i < kMade; ++i) {
    bool inside = tile.image < p.images && y0 + i < p.h;
    int at = inside ? (plane + y0 + i) * p.w + x0 : kOutside;
    vec4 line[kMade];
    [[unroll]] for (int j = 0; j < kMade; ++j) {
      int place = x0 + j < p.w ? at + j : kOutside;
      line[j] = load4_or_zero(dy, place >= 0, place);
    }
    rows[i] = gradient_transform(line);
  }
  int to = first_frequency(known_block(), known_vector(), known_first_of_group());
  int step_ = frequency_step();
  [[unroll]] for (int j = 0; j < kRead; ++j) {
    vec4 line[kMade];
    [[unroll]] for (int i = 0; i < kMade; ++i) line[i] = rows[i][j];
    vec4 column[kRead] = gradient_transform(line);
    [[unroll]] for (int i = 0; i < kRead; ++i) store4_row(transformed, true, to + (i * kRead + j) * step_, column[i])
  }
}
