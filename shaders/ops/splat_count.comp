#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "splat.glsl"

// Counts the points of every cell and leaves each point's cell, its number among that cell's (in no certain order) and what the
// gathering needs of it. One invocation takes one point.
READ1(0, uvd)
READ1(1, weight)
WRITEU(2, counts)
WRITEU(3, places)
WRITE4(4, records)

void main() {
  uint i = flat_index();
  uint pixels = p.width * p.height;
  uint hypothesis = i / pixels;  // of (B, S)
  if (hypothesis >= p.images * p.slots) return;
  vec3 point = load3(uvd, i + hypothesis * 2 * pixels, pixels);
  vec2 at;
  bool inside = lands(point, at);
  places[2 * i] = kNowhere;
  if (!inside) return;
  uvec2 cell = cell_of(at);
  uint number = cell.y * (p.width + 1) + cell.x;
  places[2 * i] = number;
  places[2 * i + 1] = atomicAdd(counts[hypothesis / p.slots * p.cells + number], 1u);
  store4(records, i, vec4(at, load1(weight, i), point.z))
}
