// The motions of camera and objects. Include precise.glsl and turns.glsl and declare READ1 bindings turns (angles, or matrices with
// TURNS) and m23 before.
#include "camera_motion.glsl"

#ifdef TURNS
mat3 object_turn(uint object) { return load_matrix(turns, object); }
#else
mat3 object_turn(uint object) {
  float angle = load1(turns, object);
  vec2 turn = precise_cos_sin(angle);
  return mat3(turn.x, turn.y, 0, -turn.y, turn.x, 0, 0, 0, 1);
}
#endif
