// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "jacobi.glsl"
#include "turns.glsl"

// R = the rotation with the largest trace of R^T M, of matrices (objects, 3, 3). One invocation takes one.
// Forward: trace of R^T M = q^T N q for R's unit quaternion q, so q is the eigenvector of N's largest eigenvalue (Horn).
// Backward: with R^T M = P, symmetric, a change of M turns R by w where G w = vee(R^T dM - dM^T R), G = tr(P) 1 - P. So dM = R [h]x
// with G h = turn_gradient(R, dR). G's eigenvalues l are sums of two singular values of M, the smallest one with the sign of det M.
// Where one is zero, a whole circle of rotations is nearest and there is no gradient: 1 / l is l^3 / (l^4 + kLeast^4), which what
// rounding leaves of a zero does not raise.
layout(push_constant) uniform Push {
  uint objects;
  uint accumulate;
} p;

#ifdef FORWARD
READ1(0, m)
WRITE1(1, r)
#else
READ1(0, m)
READ1(1, r)
READ1(2, dr)
WRITE1(3, dm)
#endif

#ifdef FORWARD
vec4 nearest_quaternion(mat3 c) {
  mat3 k = transpose(c);  // k[row][column]
  float a[4][4];
  a[0][0] = k[0][0] + k[1][1] + k[2][2];
  a[1][1] = k[0][0] - k[1][1] - k[2][2];
  a[2][2] = k[1][1] - k[0][0] - k[2][2];
  a[3][3] = k[2][2] - k[0][0] - k[1][1];
  a[0][1] = a[1][0] = k[2][1] - k[1][2];
  a[0][2] = a[2][0] = k[0][2] - k[2][0];
  a[0][3] = a[3][0] = k[1][0] - k[0][1];
  a[1][2] = a[2][1] = k[0][1] + k[1][0];
  a[1][3] = a[3][1] = k[0][2] + k[2][0];
  a[2][3] = a[3][2] = k[1][2] + k[2][1];
  float v[4][4];
  eigen4(a, v);
  uint best = 0;
  for (uint i = 1; i < 4; ++i)
    if (a[i][i] > a[best][best]) best = i;
  return normalize(vec4(v[0][best], v[1][best], v[2][best], v[3][best]));
}
#else
const float kLeast = 1e-3;

vec3 solve(mat3 product, vec3 g) {
  float trace = product[0][0] + product[1][1] + product[2][2];
  float a[4][4];
  for (uint i = 0; i < 4; ++i)
    for (uint j = 0; j < 4; ++j) {
      if (i == 3 || j == 3)
        a[i][j] = 0.0;
      else
        a[i][j] = (i == j ? trace : 0.0) - 0.5 * (product[i][j] + product[j][i]);
    }
  float v[4][4];
  eigen4(a, v);
  vec3 h = vec3(0);
  for (uint i = 0; i < 4; ++i) {
    vec3 vector = vec3(v[0][i], v[1][i], v[2][i]);  // zero for the fourth axis
    float l = a[i][i];
    h += vector * (dot(vector, g) * l * l * l / (l * l * l * l + kLeast * kLeast * kLeast * kLeast));
  }
  return h;
}
#endif

void main() {
  uint i = flat_index();
  if (i >= p.objects) return;
#ifdef FORWARD
  add_matrix(r, i, quaternion_matrix(nearest_quaternion(load_matrix(m, i))), 0)
#else
  mat3 turn = load_matrix(r, i);
  vec3 h = solve(transpose(turn) * load_matrix(m, i), turn_gradient(turn, load_matrix(dr, i)));
  add_matrix(dm, i, turn * cross_matrix(h), p.accumulate)
#endif
}
