// variants: forward backward
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

// Rows (ego E, velocity T, turn T), T 2 or 3; the background's are (ego, 0, ..., 0) but that a direction of no turn in the plane, of T = 2,
// is (1, 0). One invocation takes one row.
layout(push_constant) uniform Push {
  uint rows;   // B (K + 1)
  uint slots;  // K
  uint ego_numbers;   // E
  uint turn_numbers;  // T
  uint want_velocity;
  uint want_turn;
  uint accumulate_velocity;
  uint accumulate_turn;
} p;

#ifdef FORWARD
READ1(0, ego)
READ1(1, velocity)
READ1(2, turn)
WRITE1(3, condition)
#else
READ1(0, dcondition)
WRITE1(1, dvelocity)
WRITE1(2, dturn)
#endif

void main() {
  uint row = flat_index();
  if (row >= p.rows) return;
  uint image = row / (p.slots + 1);
  uint slot = row - image * (p.slots + 1);
  uint object = image * p.slots + slot;  // of (B, K)
  uint first = row * (p.ego_numbers + 2 * p.turn_numbers);
  uint moves = first + p.ego_numbers;
  uint turns = moves + p.turn_numbers;
#ifdef FORWARD
  bool still = slot == p.slots;
  for (uint c = 0; c < p.ego_numbers; ++c) condition[first + c] = load1(ego, image * p.ego_numbers + c);
  for (uint c = 0; c < p.turn_numbers; ++c) {
    condition[moves + c] = still ? 0.0 : load1(velocity, object * 3 + c);
    condition[turns + c] = still ? (c == 0 && p.turn_numbers == 2 ? 1.0 : 0.0) : load1(turn, object * p.turn_numbers + c);
  }
#else
  if (slot == p.slots) return;
  for (uint c = 0; c < 3; ++c)
    if (p.want_velocity != 0)
      add1(dvelocity, object * 3 + c, c < p.turn_numbers ? load1(dcondition, moves + c) : 0.0, p.accumulate_velocity)
  for (uint c = 0; c < p.turn_numbers; ++c)
    if (p.want_turn != 0)
      add1(dturn, object * p.turn_numbers + c, load1(dcondition, turns + c), p.accumulate_turn)
#endif
}
