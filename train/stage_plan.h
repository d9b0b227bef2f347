#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/config.h"

namespace vkopple {

/// A stage of training with its place in the run: steps `begin` to `end` - 1, counted from 0.
struct PlannedStage {
  TrainingStage stage;
  uint64_t begin = 0;
  uint64_t end = 0;
};

/// What a run does, step by step. A stage begins at the same step whatever the run's length is.
class StagePlan {
 public:
  /// `total`: steps of the whole run; the stages beyond are left out, and the last goes on up to there. Without
  /// it every stage has the steps that the configuration gives; one that is to go on to the end of training
  /// shows as many triplets as the authors' (docs/model.md §7).
  StagePlan(const Config& config, std::optional<uint64_t> total);

  const std::vector<PlannedStage>& stages() const { return stages_; }
  uint64_t steps() const { return stages_.back().end; }

  /// The stage of step `step`; the last one for all that lies beyond.
  size_t stage_of(uint64_t step) const;

 private:
  std::vector<PlannedStage> stages_;
};

}  // namespace vkopple
