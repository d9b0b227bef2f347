#include "models/object_motion.h"

#include "graph/ops/binary.h"
#include "graph/ops/concat.h"
#include "graph/ops/location_loss.h"
#include "graph/ops/move_pixels.h"
#include "graph/ops/nearest_rotation.h"
#include "graph/ops/pose_resample.h"
#include "graph/ops/reduce_sum.h"
#include "graph/ops/rotate_pose.h"
#include "graph/ops/rotation_angle.h"
#include "graph/ops/rotation_posterior.h"
#include "graph/ops/rotation_vector.h"
#include "graph/ops/transform_points.h"
#include "graph/ops/vector_rotation.h"
#include "graph/ops/weighted_sum.h"
#include "models/learned_motion.h"

namespace vkopple {
namespace {

/// a b, of matrices (B, K, 3, 3); a size of 1 repeats. `transposed`: a bᵀ.
Value product(Value a, Value b, bool transposed = false) {
  Graph& graph = a.graph();
  const Shape sa = a.shape(), sb = b.shape();
  const Shape rows = transposed ? Shape{sa[0], sa[1], 3, 1, 3} : Shape{sa[0], sa[1], 3, 3, 1};
  const Value parts =
      mul(graph.reshape(a, row_major(rows)), graph.reshape(b, row_major({sb[0], sb[1], 1, 3, 3})));
  return reduce_sum(parts, {transposed ? size_t{4} : size_t{3}});
}

/// §4: distributions over yaw.
void turn_in_the_plane(ObjectMotion& motion, Value log_pose1, Value log_pose2, const CameraMotion& camera) {
  const Value seen1 = pose_resample(log_pose1, camera.resampling, camera.index12);
  const auto rotation = rotation_posterior(seen1, log_pose2);
  motion.direction = rotation[1];
  motion.omega = rotation_angle(motion.direction, motion.q);
  motion.predicted.log_pose =
      pose_resample(rotate_pose(log_pose2, rotation[0]), camera.resampling, camera.index23);
}

/// §8: R_k² against the mean of what matches it, Σ_l w_kl R_k² (R_cam R_l¹)ᵀ = R_k² (R_cam Σ_l w_kl R_l¹)ᵀ.
void turn_in_space(ObjectMotion& motion, Value rotation1, Value rotation2, Value q,
                   const CameraMotion& camera) {
  const Value seen1 = product(camera.turn12, rotation1);
  const Value expected = nearest_rotation(product(rotation2, seen1, true));
  motion.turn_vector = mul(rotation_vector(expected), q);
  motion.turn = vector_rotation(motion.turn_vector);
  motion.predicted.rotation = product(camera.turn23, product(motion.turn, rotation2));
}

}  // namespace

ObjectMotion object_motion(const ModelConfig& config, const ObjectState& o1, const ObjectState& o2,
                           const CameraMotion& camera, LayerFactory* learned) {
  Graph& graph = o1.location.graph();
  const Scope scope(graph, "motion");
  const Matching matching = match_objects(config, o1, o2);
  const ObjectState seen1 = in_order_of(matching, o1);
  ObjectMotion motion;
  motion.q = matching.q;
  const Shape b_k = motion.q.shape();
  const Value q = graph.reshape(motion.q, row_major({b_k[0], b_k[1], 1}));
  const auto carried = [&](Value m, Value ego, Value location) {
    return learned != nullptr ? learned_location(*learned, ego, location) : transform_points(m, location);
  };
  motion.velocity = mul(sub(o2.place(), carried(camera.m12, camera.slots_ego12, seen1.location)), q);
  motion.predicted.location = carried(camera.m23, camera.slots_ego23, add(o2.place(), motion.velocity));
  if (config.orientation == Orientation::kYaw)
    turn_in_the_plane(motion, seen1.log_pose, o2.log_pose, camera);
  else
    turn_in_space(motion, seen1.rotation, o2.rotation, q, camera);
  return motion;
}

Value moved_pixels(const ObjectState& o2, const ObjectMotion& motion, const CameraMotion& camera,
                   LayerFactory* learned, Value points) {
  if (learned == nullptr) {
    const Value turns = motion.turn ? motion.turn : motion.omega;
    return move_pixels(points, o2.place(), motion.velocity, turns, camera.m23);
  }
  const Value objects =
      concat({camera.slots_ego23, o2.place(), motion.predicted.location, motion.velocity, motion.direction}, 2);
  return learned_pixels(*learned, objects, camera.still, points);
}

PoseDivergence pose_divergence(const ModelConfig& config) {
  return config.pose_loss == PoseLossKind::kJs ? PoseDivergence::kJs : PoseDivergence::kKl;
}

Value orientation_loss(const ModelConfig& config, const ObjectState& predicted, const ObjectState& o3,
                       Value q) {
  if (config.orientation == Orientation::kYaw)
    return pose_loss(o3.log_pose, predicted.log_pose, q, pose_divergence(config));
  const Shape b_k = q.shape();
  const auto entries = [&](Value r) { return r.graph().reshape(r, row_major({b_k[0], b_k[1], 9})); };
  return weighted_sum({location_loss(entries(predicted.rotation), entries(o3.rotation), q)}, {0.5F});
}

}  // namespace vkopple
