#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace vkopple {

/// Loss terms by name, "total" among them.
using Losses = std::map<std::string, double>;

/// How several processes share a step.
struct SharedStep {
  int processes = 1;
  double exchange_seconds = 0;  ///< that a process waits in exchanges; mean over processes
  double efficiency = 1;        ///< share of the step's time that processes work on their own, mean over them
};

/// What was seen in unseen rooms; absent where it is undefined, or no network that sees it is trained yet.
struct HeldOutScores {
  std::optional<double> ari_fg;
  std::optional<double> iou;
  std::optional<double> depth_r;  ///< correlation of an image's depth with the truth, mean over images
};

/// Euclidean norms of all that a network learns.
struct NetworkNorms {
  double weights = 0;
  double gradient = 0;  ///< before it is clipped
};

/// What is told of a training step.
struct StepRecord {
  uint64_t step = 0;  ///< steps done, this one included
  std::string stage;
  int batch = 0;  ///< of all processes
  Losses losses;
  double data_seconds = 0;  ///< until its batch was there: drawn or read
  double seconds = 0;       ///< that it took, those included
  double learning_rate = 0;
  std::optional<HeldOutScores> held_out;      ///< where it was measured
  std::map<std::string, NetworkNorms> norms;  ///< of the networks that learn, where they were taken
  std::optional<SharedStep> shared;           ///< where there are several processes
  bool skipped = false;        ///< it changed nothing, as something was not finite; a loss may be so
  uint64_t skipped_steps = 0;  ///< of the run so far, this one included
};

}  // namespace vkopple
