#pragma once

#include "graph/graph.h"
#include "models/model_config.h"

namespace vkopple {

/// What one frame's slots say (docs/model.md §2.2); row-major.
struct ObjectState {
  Value location;     ///< (B, K, 3), camera coordinates
  Value log_pose;     ///< (B, K, bins), log probabilities of yaw
  Value code;         ///< (B, K, code)
  Value mask_logits;  ///< (K, B, H, W); empty where the mask decoder did not run
  Value masks;        ///< (B, K+1, H, W), background last; likewise
};

/// raw: (B, K, 3 + bins + code); mask_logits: (K, B, H, W), or empty.
ObjectState object_state(const ModelConfig& config, Value raw, Value mask_logits);

/// How the objects of frame b are those of frame a (§3).
struct Matching {
  Value log_w;  ///< (B, K, K), rows are frame b's slots
  Value q;      ///< (B, K)
};
Matching match_objects(const ModelConfig& config, const ObjectState& a, const ObjectState& b);

/// Camera motion between frames, from the host (models/camera.h); no gradients.
struct CameraMotion {
  Value m12, m23;          ///< (B, 4, 4), maps of a static point
  Value ego23;             ///< (B, 3): v_x, v_y, omega
  Value index12, index23;  ///< u32 (B), resampling indices of -omega
  Value resampling;        ///< (361, bins, bins), the matrices T
};

/// What the rigid motion of §4 says of frame 3.
struct ObjectMotion {
  Value q;          ///< (B, K) of frames 1 → 2
  Value velocity;   ///< (B, K, 3), camera 2's coordinates
  Value location3;  ///< (B, K, 3), predicted
  Value direction;  ///< (B, K, 2), unit vector of the expected turn
  Value omega;      ///< (B, K), the turn, scaled by q
  Value log_pose3;  ///< (B, K, bins), predicted
};
ObjectMotion object_motion(const ModelConfig& config, const ObjectState& o1, const ObjectState& o2,
                           const CameraMotion& camera);

}  // namespace vkopple
