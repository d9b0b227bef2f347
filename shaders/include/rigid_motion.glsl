// The motions of camera and objects. Include precise.glsl and declare READ1 bindings location, omega and m23
// before.
mat3 camera_turn(uint image) {
  mat3 m;
  for (uint row = 0; row < 3; ++row)
    for (uint column = 0; column < 3; ++column) m[column][row] = load1(m23, image * 16 + row * 4 + column);
  return m;
}
vec3 camera_shift(uint image) {
  return vec3(load1(m23, image * 16 + 3), load1(m23, image * 16 + 7), load1(m23, image * 16 + 11));
}
mat3 object_turn(uint object) {
  float angle = load1(omega, object);
  vec2 turn = precise_cos_sin(angle);
  return mat3(turn.x, turn.y, 0, -turn.y, turn.x, 0, 0, 0, 1);
}
#define object_vector(name, object) vec3(load1(name, (object) * 3), load1(name, (object) * 3 + 1), load1(name, (object) * 3 + 2))
