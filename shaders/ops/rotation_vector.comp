// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"
#include "turns.glsl"

// v = the turn of a rotation R: its axis, as long as its angle, at most pi. (objects, 3, 3) -> (objects, 3); one invocation takes one.
// A turn of R by w, R -> R (1 + [w]x), changes v by (1 + [v]x / 2 + c [v]x^2) w with c = (1 - t cot t) / |v|^2, t = |v| / 2. So the
// gradient of R is R [u]x / 2 with u = (1 - [v]x / 2 + c [v]x^2) dv: what it says of changes that leave R a rotation; of others nothing.
layout(push_constant) uniform Push {
  uint objects;
  uint accumulate;
} p;

#ifdef FORWARD
READ1(0, r)
WRITE1(1, v)
#else
READ1(0, r)
READ1(1, v)
READ1(2, dv)
WRITE1(3, dr)
#endif

#ifdef FORWARD
// Shepperd: the largest of four squares first, so that nothing cancels.
vec4 quaternion_of(mat3 c) {
  mat3 k = transpose(c);  // k[row][column]
  float trace = k[0][0] + k[1][1] + k[2][2];
  vec4 q;
  if (trace >= max(k[0][0], max(k[1][1], k[2][2])))
    q = vec4(1.0 + trace, k[2][1] - k[1][2], k[0][2] - k[2][0], k[1][0] - k[0][1]);
  else if (k[0][0] >= max(k[1][1], k[2][2]))
    q = vec4(k[2][1] - k[1][2], 1.0 + k[0][0] - k[1][1] - k[2][2], k[0][1] + k[1][0], k[0][2] + k[2][0]);
  else if (k[1][1] >= k[2][2])
    q = vec4(k[0][2] - k[2][0], k[0][1] + k[1][0], 1.0 + k[1][1] - k[0][0] - k[2][2], k[1][2] + k[2][1]);
  else
    q = vec4(k[1][0] - k[0][1], k[0][2] + k[2][0], k[1][2] + k[2][1], 1.0 + k[2][2] - k[0][0] - k[1][1]);
  return normalize(q.x < 0.0 ? -q : q);
}
#else
float third_factor(float square) {
  if (square < 0.25)
    return 0.083333333 + square * (1.38888889e-3 + square * (3.30687831e-5 + square * 8.26719577e-7));
  float t = 0.5 * sqrt(square);
  vec2 cs = precise_cos_sin(t);
  return (1.0 - t * cs.x / cs.y) / square;
}
#endif

void main() {
  uint i = flat_index();
  if (i >= p.objects) return;
#ifdef FORWARD
  vec4 q = quaternion_of(load_matrix(r, i));
  float s = length(q.yzw);
  float scale = s > 0.0 ? 2.0 * precise_atan2(s, q.x) / s : 2.0;
  add_vector(v, i, scale * q.yzw, 0)
#else
  vec3 turn = load_vector(v, i);
  vec3 g = load_vector(dv, i);
  vec3 across = cross(turn, g);
  vec3 u = g - 0.5 * across + third_factor(dot(turn, turn)) * cross(turn, across);
  add_matrix(dr, i, 0.5 * load_matrix(r, i) * cross_matrix(u), p.accumulate)
#endif
}
