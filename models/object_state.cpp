#include "models/object_state.h"

#include "graph/ops/align.h"
#include "graph/ops/binary.h"
#include "graph/ops/decode_location.h"
#include "graph/ops/match.h"
#include "graph/ops/pose_resample.h"
#include "graph/ops/rotate_pose.h"
#include "graph/ops/rotation_angle.h"
#include "graph/ops/rotation_posterior.h"
#include "graph/ops/slice.h"
#include "graph/ops/slot_masks.h"
#include "graph/ops/softmax.h"
#include "graph/ops/transform_points.h"

namespace vkopple {

ObjectState object_state(const ModelConfig& config, Value raw, Value mask_logits) {
  ObjectState state;
  state.location = decode_location(raw, static_cast<float>(config.fov), static_cast<float>(config.max_depth),
                                   static_cast<float>(config.max_height));
  state.log_pose = softmax(slice(raw, 2, 3, config.bins), 2, true);
  state.code = slice(raw, 2, 3 + config.bins, config.code);
  state.mask_logits = mask_logits;
  if (mask_logits) state.masks = slot_masks(mask_logits);
  return state;
}

Matching match_objects(const ModelConfig& config, const ObjectState& a, const ObjectState& b) {
  const auto out = match(a.code, b.code, config.identity);
  return {.log_w = out[0], .q = out[1]};
}

ObjectMotion object_motion(const ModelConfig& config, const ObjectState& o1, const ObjectState& o2,
                           const CameraMotion& camera) {
  Graph& graph = o1.location.graph();
  const Scope scope(graph, "motion");
  const Matching matching = match_objects(config, o1, o2);
  const auto aligned = align(matching.log_w, o1.location, o1.log_pose);
  ObjectMotion motion;
  motion.q = matching.q;
  const Shape b_k = motion.q.shape();
  const Value q = graph.reshape(motion.q, row_major({b_k[0], b_k[1], 1}));
  motion.velocity = mul(sub(o2.location, transform_points(camera.m12, aligned[0])), q);
  motion.location3 = transform_points(camera.m23, add(o2.location, motion.velocity));
  const Value seen1 = pose_resample(aligned[1], camera.resampling, camera.index12);
  const auto rotation = rotation_posterior(seen1, o2.log_pose);
  motion.direction = rotation[1];
  motion.omega = rotation_angle(motion.direction, motion.q);
  motion.log_pose3 = pose_resample(rotate_pose(o2.log_pose, rotation[0]), camera.resampling, camera.index23);
  return motion;
}

}  // namespace vkopple
