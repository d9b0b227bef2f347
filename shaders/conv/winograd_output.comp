// variants: f2 f4
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "access.glsl"
#include "winograd.glsl"
#include "winograd_tiles.glsl"

// y (+)= A^T M A + bias, of every tile, as far as it lies within the image. y is NC4HW4.
layout(constant_id = 1) const uint kAccumulate = 0;
layout(constant_id = 2) const bool kWhole = false;  // no tile reaches beyond its image

READ4(0, transformed)
READ1(1, bias)
WRITE4(2, y)

float bias_of(int channel) { return load1_or_zero(bias, p.has_bias != 0 && channel < p.channels, channel); }

void main() {
  Tile tile = find_tile();
  int from = first_frequency();
  int step_ = frequency_step();
  vec4 rows[kRead][kMade];
  [[unroll]] for (int i = 0; i < kRead; ++i) {
    vec4 line[kRead];
    [[unroll]] for (int j = 0; j < kRead; ++j) line[j] = load4(transformed, from + (i * kRead + j) * step_);
    rows[i] = output_transform(line);
  }
  int c = 4 * int(gl_WorkGroupID.x);
  vec4 start = vec4(bias_of(c), bias_of(c + 1), bias_of(c + 2), bias_of(c + 3));
  int y0 = tile.row * kMade;
  int x0 = tile.column * kMade;
  int at = ((tile.image * p.channels4 + int(gl_WorkGroupID.x)) * p.h + y0) * p.w + x0;
  if (tile.image >= p.images) return;
  [[unroll]] for (int j = 0; j < kMade; ++j) {
    vec4 line[kRead];
    [[unroll]] for (int i = 0; i < kRead; ++i) line[i] = rows[i][j];
    vec4 column[kMade] = output_transform(line);
    [[unroll]] for (int i = 0; i < kMade; ++i)
      if (kWhole || (y0 + i < p.h && x0 + j < p.w)) add4(y, at + i * p.w + j, column[i] + start, kAccumulate)
  }
}
