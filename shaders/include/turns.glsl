// Matrices (…, 3, 3) and vectors (…, 3) of row-major tensors, by the number of the object, and how they speak of turns. Include
// access.glsl before.
#define load_matrix(name, object)                                                                                       \
  transpose(mat3(load1(name, (object) * 9), load1(name, (object) * 9 + 1), load1(name, (object) * 9 + 2),               \
                 load1(name, (object) * 9 + 3), load1(name, (object) * 9 + 4), load1(name, (object) * 9 + 5),           \
                 load1(name, (object) * 9 + 6), load1(name, (object) * 9 + 7), load1(name, (object) * 9 + 8)))
#define load_vector(name, object) vec3(load1(name, (object) * 3), load1(name, (object) * 3 + 1), load1(name, (object) * 3 + 2))
#define add_matrix(name, object, m, accumulate)                                                 \
  {                                                                                             \
    mat3 matrix_ = m;                                                                           \
    for (uint row_ = 0; row_ < 3; ++row_)                                                       \
      for (uint column_ = 0; column_ < 3; ++column_)                                            \
        add1(name, (object) * 9 + row_ * 3 + column_, matrix_[column_][row_], accumulate)       \
  }
#define add_vector(name, object, v, accumulate)                                                 \
  {                                                                                             \
    vec3 vector_ = v;                                                                           \
    for (uint axis_ = 0; axis_ < 3; ++axis_) add1(name, (object) * 3 + axis_, vector_[axis_], accumulate) \
  }

// [v]x, with [v]x w = v x w.
mat3 cross_matrix(vec3 v) { return mat3(0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0); }

// What a gradient d of R says of turns of R: <d, R [w]x> = turn_gradient(R, d) . w for every w.
vec3 turn_gradient(mat3 r, mat3 d) {
  mat3 c = transpose(r) * d;
  return vec3(c[1][2] - c[2][1], c[2][0] - c[0][2], c[0][1] - c[1][0]);
}

// The rotation of a unit quaternion (w, x, y, z).
mat3 quaternion_matrix(vec4 q) {
  float w = q.x, x = q.y, y = q.z, z = q.w;
  return transpose(mat3(w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),  //
                        2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x),  //
                        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z));
}
