// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// NC4HW4: y(i, j) = mean of x over rows floor(i H / h) <= row < ceil((i + 1) H / h) and columns likewise. dx gathers from every
// bin that a pixel lies in: bins floor(row h / H) up to ceil((row + 1) h / H) - 1, by solving the two bounds for i.
// One invocation takes one vec4 of what it writes.
layout(push_constant) uniform Push {
  uint vec4s;
  uint height;  // of x
  uint width;
  uint out_height;  // of y
  uint out_width;
  uint accumulate;
} p;

#ifdef FORWARD
READ4(0, x)
WRITE4(1, y)
#else
READ4(0, dy)
WRITE4(1, dx)
#endif

// Of `size` positions onto `other` ones, the range that position i covers: first, and one past the last.
uvec2 covered(uint i, uint size, uint other) { return uvec2(i * other / size, ((i + 1) * other + size - 1) / size); }
uint extent(uvec2 range) { return range.y - range.x; }

void main() {
  uint n = flat_index();
  if (n >= p.vec4s) return;
  vec4 sum = vec4(0);
#ifdef FORWARD
  uint plane = n / (p.out_height * p.out_width);
  uvec2 rows = covered(n / p.out_width % p.out_height, p.out_height, p.height);
  uvec2 columns = covered(n % p.out_width, p.out_width, p.width);
  for (uint i = rows.x; i < rows.y; ++i) {
    vec4 line = vec4(0);
    for (uint j = columns.x; j < columns.y; ++j) line += load4(x, (plane * p.height + i) * p.width + j);
    sum += line;
  }
  vec4 v = sum / float(extent(rows) * extent(columns));
  store4(y, n, v)
#else
  uint plane = n / (p.height * p.width);
  uvec2 bin_rows = covered(n / p.width % p.height, p.height, p.out_height);
  uvec2 bin_columns = covered(n % p.width, p.width, p.out_width);
  for (uint i = bin_rows.x; i < bin_rows.y; ++i)
    for (uint j = bin_columns.x; j < bin_columns.y; ++j) {
      uint pixels = extent(covered(i, p.out_height, p.height)) * extent(covered(j, p.out_width, p.width));
      sum += load4(dy, (plane * p.out_height + i) * p.out_width + j) / float(pixels);
    }
  add4(dx, n, sum, p.accumulate)
#endif
}
