// variants: strips sums strips_turns sums_turns
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "precise.glsl"
#include "turns.glsl"

// Gradients of what moves the objects, sums over all pixels in a fixed order. With g = M^T dmoved and o = P - X: dv = sum g and
// dX = (1 - R^T) dv. Of angles, R = Rz(omega) and u the z axis: domega = sum g (u x R o). Of matrices, in `_turns`: dR = sum g o^T.
// `strips`: one invocation sums over every strips-th pixel of an object; `sums`: one invocation finishes one object.
#if defined(STRIPS_TURNS) || defined(SUMS_TURNS)
#define TURNS
const uint kParts = 3;  // vec4s of a strip: row by row, dv and dR
#else
const uint kParts = 1;  // dv and domega
#endif
layout(push_constant) uniform Push {
  uint images;
  uint slots;  // K
  uint pixels;
  uint strips;
  uint want_location;
  uint want_velocity;
  uint want_turns;
  uint accumulate_location;
  uint accumulate_velocity;
  uint accumulate_turns;
} p;

#if defined(STRIPS) || defined(STRIPS_TURNS)
READ1(0, location)
READ1(1, turns)  // of angles; matrices have no part in their own gradient
READ1(2, m23)
READ1(3, points)
READ1(4, dmoved)
WRITE4(5, partial)
#include "rigid_motion.glsl"

void main() {
  uint i = flat_index();
  uint object = i / p.strips;
  if (object >= p.images * p.slots) return;
  uint image = object / p.slots;
  mat3 turn = camera_turn(image);
#ifndef TURNS
  mat3 own = object_turn(object);
#endif
  vec3 at = load_vector(location, object);
  uint points_plane = image * 3 * p.pixels;
  uint moved_plane = (object + image) * 3 * p.pixels;  // each image before has a background too
  vec4 sum[kParts];
  for (uint part = 0; part < kParts; ++part) sum[part] = vec4(0);
  for (uint pixel = i - object * p.strips; pixel < p.pixels; pixel += p.strips) {
    vec3 g = load3(dmoved, moved_plane + pixel, p.pixels) * turn;
    vec3 o = load3(points, points_plane + pixel, p.pixels) - at;
#ifdef TURNS
    for (uint row = 0; row < 3; ++row) sum[row] += g[row] * vec4(1, o);
#else
    vec3 q = own * o;
    sum[0] += vec4(g, g.y * q.x - g.x * q.y);
#endif
  }
  for (uint part = 0; part < kParts; ++part) store4(partial, i * kParts + part, sum[part])
}
#else
READ1(0, turns)
READ4(1, partial)
WRITE1(2, dlocation)
WRITE1(3, dvelocity)
WRITE1(4, dturns)

void main() {
  uint object = flat_index();
  if (object >= p.images * p.slots) return;
  vec4 sum[kParts];
  for (uint part = 0; part < kParts; ++part) sum[part] = vec4(0);
  for (uint strip = 0; strip < p.strips; ++strip)
    for (uint part = 0; part < kParts; ++part) sum[part] += load4(partial, (object * p.strips + strip) * kParts + part);
#ifdef TURNS
  vec3 dv = vec3(sum[0].x, sum[1].x, sum[2].x);
  vec3 dx = (mat3(1) - transpose(load_matrix(turns, object))) * dv;
  if (p.want_turns != 0)
    add_matrix(dturns, object, transpose(mat3(sum[0].yzw, sum[1].yzw, sum[2].yzw)), p.accumulate_turns)
#else
  vec3 dv = sum[0].xyz;
  float angle = load1(turns, object);
  float s = precise_cos_sin(angle).y;
  // (1 - Rz^T) dv; 1 - cos through half the angle, which keeps the digits of small turns.
  float half_sine = precise_cos_sin(0.5 * angle).y;
  float less = 2.0 * half_sine * half_sine;
  vec3 dx = vec3(less * dv.x - s * dv.y, less * dv.y + s * dv.x, 0);
  if (p.want_turns != 0) add1(dturns, object, sum[0].w, p.accumulate_turns)
#endif
  if (p.want_location != 0) add_vector(dlocation, object, dx, p.accumulate_location)
  if (p.want_velocity != 0) add_vector(dvelocity, object, dv, p.accumulate_velocity)
}
#endif
