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

/// What is told of a training step.
struct StepRecord {
  uint64_t step = 0;  ///< steps done, this one included
  std::string stage;
  int batch = 0;  ///< of all processes
  Losses losses;
  double data_seconds = 0;           ///< until its batch was there: drawn or read
  double seconds = 0;                ///< that it took, those included
  std::optional<double> depth_r;     ///< correlation with true depth in unseen rooms, where it was measured
  std::optional<SharedStep> shared;  ///< where there are several processes
};

}  // namespace vkopple
