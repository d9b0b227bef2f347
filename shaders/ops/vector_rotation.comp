// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "precise.glsl"
#include "turns.glsl"

// R = the rotation about v by |v|: 1 + a [v]x + b [v]x^2 with a = sin |v| / |v|, b = (1 - cos |v|) / |v|^2 (Rodrigues). (objects, 3) ->
// (objects, 3, 3); one invocation takes one.
// A change dv turns R by w = (1 - b [v]x + d [v]x^2) dv, R -> R (1 + [w]x), with d = (|v| - sin |v|) / |v|^3. So the gradient of v is
// (1 + b [v]x + d [v]x^2) turn_gradient(R, dR).
layout(push_constant) uniform Push {
  uint objects;
  uint accumulate;
} p;

#ifdef FORWARD
READ1(0, v)
WRITE1(1, r)
#else
READ1(0, v)
READ1(1, r)
READ1(2, dr)
WRITE1(3, dv)
#endif

// (a, b, d) of |v|^2.
vec3 factors(float square) {
  if (square < 0.25)
    return vec3(1.0 + square * (-0.16666667 + square * (8.3333333e-3 - square * 1.98412698e-4)),
                0.5 + square * (-0.041666667 + square * (1.38888889e-3 - square * 2.48015873e-5)),
                0.16666667 + square * (-8.3333333e-3 + square * (1.98412698e-4 - square * 2.75573192e-6)));
  float angle = sqrt(square);
  vec2 cs = precise_cos_sin(angle);
  return vec3(cs.y / angle, (1.0 - cs.x) / square, (angle - cs.y) / (angle * square));
}

void main() {
  uint i = flat_index();
  if (i >= p.objects) return;
  vec3 turn = load_vector(v, i);
  vec3 f = factors(dot(turn, turn));
#ifdef FORWARD
  mat3 k = cross_matrix(turn);
  add_matrix(r, i, mat3(1) + f.x * k + f.y * (k * k), 0)
#else
  vec3 g = turn_gradient(load_matrix(r, i), load_matrix(dr, i));
  vec3 across = cross(turn, g);
  add_vector(dv, i, g + f.y * across + f.z * cross(turn, across), p.accumulate)
#endif
}
