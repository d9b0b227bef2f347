#pragma once

#include "graph/graph.h"
#include "models/model_config.h"

namespace vkopple {

/// What one frame's slots say (docs/model.md §2.2); row-major.
struct ObjectState {
  Value location;     ///< (B, K, 3), camera coordinates
  Value log_pose;     ///< (B, K, bins), log probabilities of yaw; empty with Euler angles
  Value rotation;     ///< (B, K, 3, 3), object to camera, of Euler angles; empty with yaw
  Value code;         ///< (B, K, code)
  Value mask_logits;  ///< (K, B, H, W); empty where the mask decoder did not run
  Value masks;        ///< (B, K+1, H, W), background last; likewise
  Value centroid;     ///< (B, K, 3), of masks; empty without `mask_location`, and without masks

  /// Where the objects are: at their masks' centroids with `mask_location`.
  const Value& place() const { return centroid ? centroid : location; }
};

/// raw: (B, K, 3 + orientation + code); mask_logits: (K, B, H, W), or empty; depth: (B, 1, H, W), which
/// `mask_window` and `mask_location` ask for where there are masks.
ObjectState object_state(const ModelConfig& config, Value raw, Value mask_logits, Value depth);

/// How the objects of frame b are those of frame a (§3).
struct Matching {
  Value log_w;  ///< (B, K, K), rows are frame b's slots
  Value q;      ///< (B, K)
};
Matching match_objects(const ModelConfig& config, const ObjectState& a, const ObjectState& b);

/// Locations and orientations of frame a in the order of b's slots; a mean of rotations is none itself.
ObjectState in_order_of(const Matching& matching, const ObjectState& a);

}  // namespace vkopple
