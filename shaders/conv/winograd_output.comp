// variants: f2 f4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "row_store.glsl"
#include "winograd.glsl"
#include "winograd_tiles.glsl"

// y (+)= A^T M A + bias, of every tile, as far as it lies within the image. y is NC4HW4.
layout(constant_id = 1) const uint kAccumulate = 0;
layout(constant_id = 2) const bool kWhole = false;  // no tile reaches beyond its image

READ4(0, transformed)
READ1(1, bias)
WRITE4(2, y)
READ4(3, old)  // y, where rows are stored

float bias_of(int channel) { return load1_or_zero(bias, p.has_bias != 0 && channel < p.channels, channel); }

int first_output(Tile tile, int vector) {
  return ((tile.image * p.channels4 + vector) * p.h + tile.row * kMade) * p.w + tile.column * kMade;
}
bool lies_inside(Tile tile, int i, int j) {
  return kWhole || (tile.row * kMade + i < p.h && tile.column * kMade + j < p.w);
}

vec4[kMade] output_column(vec4 rows[kRead][kMade], int j) {
  vec4 line[kRead];
  [[unroll]] for (int i = 0; i < kRead; ++i) line[i] = rows[i][j];
  return output_transform(line);
}

#ifdef TEXEL
// Every lane's tile is found once more for all lanes, from what is known to be uniform (row_store.glsl).
void store_known(vec4 rows[kRead][kMade], vec4 start, Tile mine) {
  int mine_at = first_output(mine, int(gl_WorkGroupID.x));
  u64vec2 words[kMade][kMade];
  [[unroll]] for (int j = 0; j < kMade; ++j) {
    vec4 column[kMade] = output_column(rows, j);
    [[unroll]] for (int i = 0; i < kMade; ++i) {
      vec4 v = column[i] + start;
      if (kAccumulate != 0)
        v += load4_or_zero(old, mine.image < p.images && lies_inside(mine, i, j), mine_at + i * p.w + j);
      words[i][j] = ROW_WORDS(y, v);
    }
  }
  int vector = known_vector();
  int block = known_block();
  int within = known_first_of_group();
  [[unroll]] for (int l = 0; l < kMostLanes; ++l) {
    Tile tile = tile_at(block, within + l);
    int at = first_output(tile, vector);
    bool there = tile.image < p.images;
    [[unroll]] for (int i = 0; i < kMade; ++i)
      [[unroll]] for (int j = 0; j < kMade; j += 2) {
        if (kWhole) {  // which makes p.w even
          STORE_LANES(y, there, at + i * p.w + j, words[i][j], l, words[i][j + 1], l)
        } else {
          STORE_LANE(y, there && lies_inside(tile, i, j), at + i * p.w + j, words[i][j], l)
          STORE_LANE(y, there && lies_inside(tile, i, j + 1), at + i * p.w + j + 1, words[i][j + 1], l)
        }
      }
  }
}
#endif

void main() {
  ALIGN_SPILLS(y)
  Tile tile = find_tile();
  int from = first_frequency(int(gl_WorkGroupID.z), int(gl_WorkGroupID.x), first_of_group()) + int(gl_LocalInvocationID.x);
  int step_ = frequency_step();
  vec4 rows[kRead][kMade];
  [[unroll]] for (int i = 0; i < kRead; ++i) {
    vec4 line[kRead];
    [[unroll]] for (int j = 0; j < kRead; ++j) line[j] = load4(transformed, from + (i * kRead + j) * step_);
    rows[i] = output_transform(line);
  }
  int c = 4 * int(gl_WorkGroupID.x);
  vec4 start = vec4(bias_of(c), bias_of(c + 1), bias_of(c + 2), bias_of(c + 3));
#ifdef TEXEL
  if (kRowStores) {
    store_known(rows, start, tile);
    return;
  }
#endif
  if (tile.image >= p.images) return;
  int at = first_output(tile, int(gl_WorkGroupID.x));
  [[unroll]] for (int j = 0; j < kMade; ++j) {
    vec4 column[kMade] = output_column(rows, j);
    [[unroll]] for (int i = 0; i < kMade; ++i)
      if (lies_inside(tile, i, j)) add4(y, at + i * p.w + j, column[i] + start, kAccumulate)
  }
}
