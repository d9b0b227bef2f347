// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "turns.glsl"

// R = Rz(yaw) Rx(pitch) Ry(roll) of (objects, 6): three pairs, in that order, that point along (cos, sin). (objects, 3, 3); one
// invocation takes one. A pair shorter than kShortest points nowhere: it counts as (1, 0) and has no gradient.
layout(push_constant) uniform Push {
  uint objects;
  uint accumulate;
} p;

READ1(0, pairs)
#ifdef FORWARD
WRITE1(1, r)
#else
READ1(1, r)
READ1(2, dr)
WRITE1(3, dpairs)
#endif

const float kShortest = 1e-4;

vec2 pair(uint object, uint angle) {
  return vec2(load1(pairs, object * 6 + angle * 2), load1(pairs, object * 6 + angle * 2 + 1));
}

vec2 unit(vec2 v) {
  float size = length(v);
  return size < kShortest ? vec2(1, 0) : v / size;
}

mat3 about_z(vec2 a) { return mat3(a.x, a.y, 0, -a.y, a.x, 0, 0, 0, 1); }
mat3 about_x(vec2 a) { return mat3(1, 0, 0, 0, a.x, a.y, 0, -a.y, a.x); }
mat3 about_y(vec2 a) { return mat3(a.x, 0, -a.y, 0, 1, 0, a.y, 0, a.x); }

#ifdef BACKWARD
// d: the gradient of (cos, sin) of one angle.
void add_pair(uint object, uint angle, vec2 d) {
  vec2 v = pair(object, angle);
  float size = length(v);
  vec2 direction = v / size;
  vec2 g = size < kShortest ? vec2(0) : (d - direction * dot(direction, d)) / size;
  add1(dpairs, object * 6 + angle * 2, g.x, p.accumulate)
  add1(dpairs, object * 6 + angle * 2 + 1, g.y, p.accumulate)
}
#endif

void main() {
  uint i = flat_index();
  if (i >= p.objects) return;
  mat3 z = about_z(unit(pair(i, 0)));
  mat3 x = about_x(unit(pair(i, 1)));
  mat3 y = about_y(unit(pair(i, 2)));
#ifdef FORWARD
  add_matrix(r, i, z * x * y, 0)
#else
  // With R = z x y: dz = dR (x y)^T = dR R^T z, dx = z^T dR y^T, dy = (z x)^T dR = y R^T dR.
  mat3 d = load_matrix(dr, i);
  mat3 back = transpose(load_matrix(r, i));
  mat3 dz = d * back * z;
  mat3 dx = transpose(z) * d * transpose(y);
  mat3 dy = y * back * d;
  add_pair(i, 0, vec2(dz[0][0] + dz[1][1], dz[0][1] - dz[1][0]));
  add_pair(i, 1, vec2(dx[1][1] + dx[2][2], dx[1][2] - dx[2][1]));
  add_pair(i, 2, vec2(dy[0][0] + dy[2][2], dy[2][0] - dy[0][2]));
#endif
}
