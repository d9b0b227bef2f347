#pragma once

#include "graph/op.h"

namespace vkopple {

/// Sizes of the kernels that move pixels rigidly, as move_pixels.comp takes them. K may be 0: the background
/// alone.
struct RigidMotion {
  uint32_t images;  ///< B
  uint32_t slots;   ///< K
  uint32_t pixels;  ///< H·W
};

/// What moves the objects; empty slices without objects.
struct MotionSlices {
  Slice location;  ///< (B, K, 3)
  Slice velocity;  ///< (B, K, 3)
  Slice turn;      ///< (B, K), angles about the z axis; or (B, K, 3, 3), rotations
  Slice m23;       ///< (B, 4, 4)
};

/// What the turns of objects are given as.
enum class Turns { kAngles, kMatrices };

/// moved (B, K+1, 3, H, W) from points (B, 3, H, W): M [R (P − X) + X + v] for objects, M P for the background.
void record_moved(Recorder& recorder, const RigidMotion& sizes, Turns turns, const Slice& points,
                  const MotionSlices& motion, const Slice& moved);
/// Writes or adds the gradient with respect to the points.
void record_moved_dpoints(Recorder& recorder, const RigidMotion& sizes, Turns turns, const MotionSlices& motion,
                          const Slice& dmoved, const Slice& dpoints, bool accumulate);

}  // namespace vkopple
