#pragma once

#include <span>

#include "graph/executor.h"
#include "graph/graph.h"
#include "models/camera.h"
#include "models/model_config.h"

namespace vkopple {

/// How the camera moves between the frames of a batch of triplets, as inputs of a graph; no gradients. What a
/// configuration does not need is empty.
class CameraMotion {
 public:
  CameraMotion() = default;
  /// `background_only`: m23 alone.
  CameraMotion(Graph& graph, const ModelConfig& config, int64_t batch, bool background_only);

  /// Writes everything but constants. poses: 3 × B, frame after frame.
  void feed(Executor& executor, std::span<const CameraPose> poses) const;
  /// Writes what stays. Once, after the executor is made.
  void feed_constants(Executor& executor) const;

  Value m12, m23;  ///< (B, 4, 4), maps of a static point; not of learned motion
  Value ego23;     ///< (B, 3): v_x, v_y, omega; with Euler angles (B, 6): translation, turn vector
  // Of yaw.
  Value index12, index23;  ///< u32 (B), resampling indices of -omega
  Value resampling;        ///< (361, bins), first rows of the matrices T
  // Of Euler angles.
  Value turn12, turn23;  ///< (B, 1, 3, 3), the rotations in m12 and m23
  // Of learned motion.
  Value slots_ego12, slots_ego23;  ///< (B, K, 3), ego-motions once for each slot
  Value still;  ///< (B, 1, 14), what moves the background's pixels: ego-motion 2→3 and no motion

 private:
  int64_t batch_ = 0;
};

/// Numbers that tell how the pixels of one hypothesis move in learned motion: ego-motion 3, location 3,
/// predicted location 3, velocity 3, direction 2.
inline constexpr int64_t kPixelMotionNumbers = 14;

}  // namespace vkopple
