// variants: forward points forward_turns points_turns
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"
#include "precise.glsl"
#include "turns.glsl"

// moved (B, K+1, 3, H, W) = M [R (P - X) + X + v], and M P for the background, which is last; R = Rz(omega) or, in `_turns`, a matrix.
// `forward`: one invocation takes every strips-th pixel of one hypothesis. `points`: the gradient of P, one invocation the same of an
// image.
#if defined(FORWARD_TURNS) || defined(POINTS_TURNS)
#define TURNS
#endif
#if defined(FORWARD) || defined(FORWARD_TURNS)
#define MOVES
#endif
layout(push_constant) uniform Push {
  uint images;
  uint slots;  // K
  uint pixels;
  uint strips;
  uint accumulate;
} p;

READ1(0, location)
READ1(1, velocity)
READ1(2, turns)
READ1(3, m23)
#ifdef MOVES
READ1(4, points)
WRITE1(5, moved)
#else
READ1(4, dmoved)
WRITE1(5, dpoints)
#endif

#include "rigid_motion.glsl"

#ifdef MOVES
void main() {
  uint i = flat_index();
  uint hypothesis = i / p.strips;  // of (B, K + 1)
  uint image = hypothesis / (p.slots + 1);
  if (image >= p.images) return;
  uint slot = hypothesis - image * (p.slots + 1);
  mat3 turn = camera_turn(image);
  vec3 shift = camera_shift(image);
  if (slot < p.slots) {
    uint object = image * p.slots + slot;
    mat3 own = object_turn(object);
    vec3 at = load_vector(location, object);
    shift += turn * (at + load_vector(velocity, object) - own * at);
    turn = turn * own;
  }
  for (uint pixel = i - hypothesis * p.strips; pixel < p.pixels; pixel += p.strips)
    store3(moved, hypothesis * 3 * p.pixels + pixel, p.pixels,
           turn * load3(points, image * 3 * p.pixels + pixel, p.pixels) + shift)
}
#else
const uint kMost = 4;  // pixels of an invocation: kPixelsBackward of rigid_motion.cpp

void main() {
  uint i = flat_index();
  uint image = i / p.strips;
  if (image >= p.images) return;
  uint first = i - image * p.strips;
  mat3 turn = camera_turn(image);
  vec3 sum[kMost] = vec3[kMost](vec3(0), vec3(0), vec3(0), vec3(0));
  for (uint slot = 0; slot <= p.slots; ++slot) {
    mat3 whole = slot < p.slots ? turn * object_turn(image * p.slots + slot) : turn;
    uint plane = (image * (p.slots + 1) + slot) * 3 * p.pixels;
    for (uint n = 0; n < kMost; ++n)
      if (first + n * p.strips < p.pixels) sum[n] += load3(dmoved, plane + first + n * p.strips, p.pixels) * whole;
  }
  for (uint n = 0; n < kMost; ++n)
    if (first + n * p.strips < p.pixels)
      add3(dpoints, image * 3 * p.pixels + first + n * p.strips, p.pixels, sum[n], p.accumulate)
}
#endif
