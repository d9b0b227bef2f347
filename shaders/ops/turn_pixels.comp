// variants: strips sums
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "turns.glsl"

// Gradients of what moves the objects, sums over all pixels in a fixed order. With g = M^T dmoved and o = P - X: dv = sum g,
// dR = sum g o^T, dX = (1 - R^T) dv. `strips`: one invocation sums g and g o^T over every strips-th pixel of an object; `sums`: one
// invocation finishes one object. (move_pixels.comp moves the pixels.)
layout(push_constant) uniform Push {
  uint images;
  uint slots;  // K
  uint pixels;
  uint strips;
  uint want_location;
  uint want_velocity;
  uint want_turn;
  uint accumulate_location;
  uint accumulate_velocity;
  uint accumulate_turn;
} p;

#ifdef STRIPS
READ1(0, location)
READ1(1, m23)
READ1(2, points)
READ1(3, dmoved)
WRITE4(4, partial)

#include "camera_motion.glsl"

void main() {
  uint i = flat_index();
  uint object = i / p.strips;
  if (object >= p.images * p.slots) return;
  uint image = object / p.slots;
  mat3 turn = camera_turn(image);
  vec3 at = load_vector(location, object);
  uint points_plane = image * 3 * p.pixels;
  uint moved_plane = (object + image) * 3 * p.pixels;  // each image before has a background too
  vec4 sum[3] = vec4[3](vec4(0), vec4(0), vec4(0));     // of g_row (1, o)
  for (uint pixel = i - object * p.strips; pixel < p.pixels; pixel += p.strips) {
    vec3 g = load3(dmoved, moved_plane + pixel, p.pixels) * turn;
    vec4 o = vec4(1, load3(points, points_plane + pixel, p.pixels) - at);
    for (uint row = 0; row < 3; ++row) sum[row] += g[row] * o;
  }
  for (uint row = 0; row < 3; ++row) store4(partial, i * 3 + row, sum[row])
}
#else
READ1(0, turns)
READ4(1, partial)
WRITE1(2, dlocation)
WRITE1(3, dvelocity)
WRITE1(4, dturn)

void main() {
  uint object = flat_index();
  if (object >= p.images * p.slots) return;
  vec3 dv = vec3(0);
  mat3 dr = mat3(0);
  for (uint row = 0; row < 3; ++row) {
    vec4 sum = vec4(0);
    for (uint strip = 0; strip < p.strips; ++strip) sum += load4(partial, (object * p.strips + strip) * 3 + row);
    dv[row] = sum.x;
    for (uint column = 0; column < 3; ++column) dr[column][row] = sum[column + 1];
  }
  if (p.want_location != 0)
    add_vector(dlocation, object, (mat3(1) - transpose(load_matrix(turns, object))) * dv, p.accumulate_location)
  if (p.want_velocity != 0) add_vector(dvelocity, object, dv, p.accumulate_velocity)
  if (p.want_turn != 0) add_matrix(dturn, object, dr, p.accumulate_turn)
}
#endif
