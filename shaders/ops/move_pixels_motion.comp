// variants: strips sums
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "precise.glsl"
#include "turns.glsl"

// Gradients of what moves the objects, sums over all pixels in a fixed order. With g = M^T dmoved, q = Rz(omega)(P - X) and u the z
// axis: dv = sum g, domega = sum g (u x q), dX = (1 - Rz^T) dv. `strips`: one invocation sums g and g (u x q) over every
// strips-th pixel of an object; `sums`: one invocation finishes one object.
layout(push_constant) uniform Push {
  uint images;
  uint slots;  // K
  uint pixels;
  uint strips;
  uint want_location;
  uint want_velocity;
  uint want_omega;
  uint accumulate_location;
  uint accumulate_velocity;
  uint accumulate_omega;
} p;

#ifdef STRIPS
READ1(0, location)
READ1(1, omega)
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
  mat3 own = object_turn(object);
  vec3 at = load_vector(location, object);
  uint points_plane = image * 3 * p.pixels;
  uint moved_plane = (object + image) * 3 * p.pixels;  // each image before has a background too
  vec4 sum = vec4(0);
  for (uint pixel = i - object * p.strips; pixel < p.pixels; pixel += p.strips) {
    vec3 g = load3(dmoved, moved_plane + pixel, p.pixels) * turn;
    vec3 q = own * (load3(points, points_plane + pixel, p.pixels) - at);
    sum += vec4(g, g.y * q.x - g.x * q.y);
  }
  store4(partial, i, sum)
}
#else
READ1(0, omega)
READ4(1, partial)
WRITE1(2, dlocation)
WRITE1(3, dvelocity)
WRITE1(4, domega)

void main() {
  uint object = flat_index();
  if (object >= p.images * p.slots) return;
  vec4 sum = vec4(0);
  for (uint strip = 0; strip < p.strips; ++strip) sum += load4(partial, object * p.strips + strip);
  float angle = load1(omega, object);
  float s = precise_cos_sin(angle).y;
  // (1 - Rz^T) dv; 1 - cos through half the angle, which keeps the digits of small turns.
  float half_sine = precise_cos_sin(0.5 * angle).y;
  float less = 2.0 * half_sine * half_sine;
  vec3 d = vec3(less * sum.x - s * sum.y, less * sum.y + s * sum.x, 0);
  for (uint axis = 0; axis < 3; ++axis) {
    if (p.want_location != 0) add1(dlocation, object * 3 + axis, d[axis], p.accumulate_location)
    if (p.want_velocity != 0) add1(dvelocity, object * 3 + axis, sum[axis], p.accumulate_velocity)
  }
  if (p.want_omega != 0) add1(domega, object, sum.w, p.accumulate_omega)
}
#endif
