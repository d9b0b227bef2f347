#include "train/stage_plan.h"

#include <algorithm>

#include "runtime/error.h"

namespace vkopple {
namespace {

// 55 epochs of 275 thousand triplets (docs/model.md §7).
constexpr uint64_t kPublishedTriplets = uint64_t{55} * 275'000;

uint64_t natural_steps(const TrainingStage& stage) {
  if (stage.steps) return static_cast<uint64_t>(*stage.steps);
  return std::max(uint64_t{1}, kPublishedTriplets / static_cast<uint64_t>(stage.batch));
}

}  // namespace

StagePlan::StagePlan(const Config& config, std::optional<uint64_t> total) {
  if (total && *total == 0) throw UsageError("--steps: 0 steps are no training; give at least 1");
  uint64_t begin = 0;
  for (const TrainingStage& stage : config.stages()) {
    if (total && begin >= *total) break;
    stages_.push_back({stage, begin, begin + natural_steps(stage)});
    begin = stages_.back().end;
  }
  if (total) stages_.back().end = *total;
}

size_t StagePlan::stage_of(uint64_t step) const {
  const auto found =
      std::find_if(stages_.begin(), stages_.end(), [&](const PlannedStage& s) { return step < s.end; });
  return static_cast<size_t>(std::min(found, stages_.end() - 1) - stages_.begin());
}

}  // namespace vkopple
