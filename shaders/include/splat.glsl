// What the kernels of the splat share. A point is a source pixel under one hypothesis. Coordinates are those of a grid that has a
// ring of one pixel around the image: pixel (0, 0) lies at (1, 1). Cell (column, row) is the square between the grid's pixels
// (column, row) and (column + 1, row + 1); points in other cells, and invalid ones, reach no pixel.
#include "precise.glsl"

layout(push_constant) uniform Push {
  uint images;
  uint slots;
  uint width;
  uint height;
  uint cells;        // of an image: (width + 1)(height + 1)
  uint chunks;       // of cells
  uint chunk_cells;  // of a chunk
  float beta;
  uint save;
  uint want_uvd;
  uint want_weight;
  uint accumulate_uvd;
  uint accumulate_weight;
} p;

const float kNear = 1e-5;
const uint kNowhere = 0xffffffffu;

// The point's place in the grid; false where it reaches no pixel. Written so that NaN fails every comparison.
bool lands(vec3 uvd, out vec2 at) {
  vec2 size = vec2(p.width, p.height) + 1.0;
  at = uvd.xy + 0.5 * size;
  return uvd.z > kNear && uvd.z < 1e30 && at.x >= 0.0 && at.x < size.x && at.y >= 0.0 && at.y < size.y;
}

// Of a point that lands.
uvec2 cell_of(vec2 at) { return uvec2(clamp(floor(at), vec2(0), vec2(p.width, p.height))); }

float nearness(float d) { return precise_exp(-p.beta * d); }
