// The camera's motion. Declare READ1 binding m23, (images, 4, 4), before.
mat3 camera_turn(uint image) {
  mat3 m;
  for (uint row = 0; row < 3; ++row)
    for (uint column = 0; column < 3; ++column) m[column][row] = load1(m23, image * 16 + row * 4 + column);
  return m;
}
vec3 camera_shift(uint image) {
  return vec3(load1(m23, image * 16 + 3), load1(m23, image * 16 + 7), load1(m23, image * 16 + 11));
}
