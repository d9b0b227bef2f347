#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "splat.glsl"

// Each pixel's sums over the points of its four cells, in the order of cells and lists. One invocation takes one pixel.
READU(0, starts)
READU(1, lists)
READ4(2, records)  // (x, y, weight, d)
READ1(3, image)
WRITE1(4, warped)
WRITE1(5, depth)
WRITE1(6, total)
WRITE1(7, divisors)

void main() {
  uint i = flat_index();
  uint pixels = p.width * p.height;
  uint n = i / pixels;
  if (n >= p.images) return;
  uint pixel = i - n * pixels;
  uvec2 cell = uvec2(pixel % p.width, pixel / p.width);
  vec2 here = vec2(cell + 1);
  uint points = p.slots * pixels;
  float all = 0.0;
  float divisor = 0.0;
  vec4 sum = vec4(0);
  for (uint row = 0; row < 2; ++row) {
    // Two cells side by side, whose lists lie one after the other.
    uint start = n * (p.cells + 1) + (cell.y + row) * (p.width + 1) + cell.x;
    uint end = n * points + starts[start + 2];
    for (uint at = n * points + starts[start]; at < end; ++at) {
      uint point = lists[at];
      vec4 record = load4(records, n * points + point);
      vec2 share = 1.0 - abs(record.xy - here);
      float a = share.x * share.y * record.z;
      float near = a * nearness(record.w);
      all += a;
      divisor += near;
      sum += near * vec4(load3(image, n * 3 * pixels + point % pixels, pixels), record.w);
    }
  }
  divisor += 1e-22;
  sum /= divisor;
  store3(warped, n * 3 * pixels + pixel, pixels, sum.xyz)
  depth[i] = sum.w;
  total[i] = all;
  if (p.save != 0) divisors[i] = divisor;
}
