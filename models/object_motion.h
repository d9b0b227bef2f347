#pragma once

#include "graph/ops/pose_loss.h"
#include "models/camera_motion.h"
#include "models/layers.h"
#include "models/object_state.h"

namespace vkopple {

/// What §4, or a variant of §8, says of frame 3.
struct ObjectMotion {
  Value q;                ///< (B, K) of frames 1 → 2
  Value velocity;         ///< (B, K, 3), camera 2's coordinates
  ObjectState predicted;  ///< location and orientation
  // Of yaw.
  Value direction;  ///< (B, K, 2), unit vector of the expected turn
  Value omega;      ///< (B, K), the turn, scaled by q
  // Of Euler angles.
  Value turn_vector;  ///< (B, K, 3), the expected turn, scaled by q: its axis, as long as its angle
  Value turn;         ///< (B, K, 3, 3), the same as a matrix
};

/// `learned`: the group "motion" of the relaxed variant, or null.
ObjectMotion object_motion(const ModelConfig& config, const ObjectState& o1, const ObjectState& o2,
                           const CameraMotion& camera, LayerFactory* learned);

/// Where each pixel of frame 2 goes under each hypothesis, (B, K+1, 3, H, W). points: (B, 3, H, W).
Value moved_pixels(const ObjectState& o2, const ObjectMotion& motion, const CameraMotion& camera,
                   LayerFactory* learned, Value points);

PoseDivergence pose_divergence(const ModelConfig& config);

/// The loss of orientations, predicted in the order of frame 3's slots against seen (§6, §8). q: (B, K) of
/// frames 2 → 3.
Value orientation_loss(const ModelConfig& config, const ObjectState& predicted, const ObjectState& o3, Value q);

}  // namespace vkopple
