#include "train/training_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "graph/execution_plan.h"
#include "runtime/byte_text.h"
#include "runtime/caps.h"
#include "runtime/error.h"
#include "train/held_out_probe.h"
#include "train/model_layout.h"
#include "train/parallel/agreement.h"
#include "train/rooms/room_source.h"
#include "train/step_graph.h"

namespace vkopple {
namespace {

constexpr int kProbeBatch = 16;
/// What a process grew by beyond the plan in a step of `full` on lavapipe.
constexpr uint64_t kKernelBytes = uint64_t{512} << 20;

/// A number of portions with what it takes.
struct Portions {
  int count;
  uint64_t bytes;
};

/// The fewest that take no more than `most` bytes; the most there can be where even they take more.
Portions fewest_portions(const Caps& caps, const Config& config, TrainingStage stage,
                         const TrainingSetting& setting, uint64_t most) {
  stage.accumulate = 1;
  const int whole = portion_batch(stage, setting.peers);
  Portions portions{};
  for (int count = 1; count <= whole; ++count) {
    if (whole % count != 0) continue;
    stage.accumulate = count;
    portions = {count, stage_bytes(caps, config, stage, setting)};
    if (portions.bytes <= most) break;
  }
  return portions;
}

std::string too_little(const Caps& caps, const TrainingStage& stage, uint64_t bytes, uint64_t free) {
  return fmt::format("stage {} needs {} of memory, {} has {} free", stage.name, byte_text(bytes), caps.name,
                     byte_text(free));
}

}  // namespace

int probe_batch(const TrainingStage& stage) { return std::min(stage.batch, kProbeBatch); }

uint64_t stage_bytes(const Caps& caps, const Config& config, const TrainingStage& stage,
                     const TrainingSetting& setting) {
  StepGraph step(caps, config, stage, setting.peers);
  const ExecutionPlan plan = plan_execution(caps, step.graph(), step.executor_options());
  std::map<std::string, uint64_t> groups = ModelLayout(config.model, config.training.precision).groups();
  groups.insert(plan.groups.begin(), plan.groups.end());
  uint64_t bytes = group_store_bytes(caps, groups) + plan.own_bytes();
  for (const std::string& averages : step.averages()) bytes += plan.groups.at(averages);  // the copy of them
  const ModelConfig model = stage.model_in(config.model);
  const Lens lens(model);
  if (setting.drawn)
    bytes += RoomSource::show_bytes(lens, stage.rooms, static_cast<int>(step.model().options().batch),
                                    step.model().first_frame());
  if (setting.measured)
    bytes += HeldOutProbe::device_bytes(
        caps, model, stage.rooms,
        {.batch = probe_batch(stage), .objects = stage.hypotheses != Hypotheses::kBackground});
  return bytes;
}

void require_memory(const Caps& caps, const Config& config, const std::vector<PlannedStage>& stages,
                    const TrainingSetting& setting, uint64_t free, bool resumed) {
  for (const PlannedStage& planned : stages) {
    const TrainingStage& stage = planned.stage;
    const uint64_t bytes = stage_bytes(caps, config, stage, setting);
    if (bytes <= free) continue;
    const std::string problem = too_little(caps, stage, bytes, free);
    if (resumed) throw Error(problem + "; a run keeps its batch, so go on with it where there is more memory");
    const Portions fitting = fewest_portions(caps, config, stage, setting, free);
    if (fitting.bytes > free)
      throw Error(fmt::format(
          "{}; --accumulate {}, a triplet at a time, needs {} still: use a smaller image size or model",
          problem, fitting.count, byte_text(fitting.bytes)));
    throw Error(
        fmt::format("{}; --batch {} --accumulate {} needs {} for the same training (--batch auto finds such a "
                    "number by itself)",
                    problem, stage.batch, fitting.count, byte_text(fitting.bytes)));
  }
}

uint64_t fitting_bytes(const Caps& caps, uint64_t free) {
  const uint64_t left = free - free / 10;
  return caps.cpu() ? left - std::min(left, kKernelBytes) : left;
}

std::vector<std::string> fit_memory(const Caps& caps, Config& config, const TrainingSetting& setting,
                                    uint64_t free) {
  const uint64_t most = fitting_bytes(caps, free);
  std::vector<std::string> chosen;
  const auto fit = [&](TrainingStage stage) {
    const Portions here = fewest_portions(caps, config, stage, setting, most);
    // All processes take as many as that which has least memory.
    stage.accumulate = static_cast<int>(largest(setting.peers, static_cast<float>(here.count)));
    const uint64_t bytes = stage_bytes(caps, config, stage, setting);
    if (bytes > most)
      throw Error(
          fmt::format("{}, of which {} may be taken, even with a triplet at a time (--accumulate {}): use a "
                      "smaller image size or model",
                      too_little(caps, stage, bytes, free), byte_text(most), stage.accumulate));
    chosen.push_back(fmt::format("stage {}: batch {} with --accumulate {} needs {} of {} free", stage.name,
                                 stage.batch, stage.accumulate, byte_text(bytes), byte_text(free)));
    return stage.accumulate;
  };
  if (config.training.stages.empty()) config.training.accumulate = fit(config.stages().front());
  for (TrainingStage& stage : config.training.stages) stage.accumulate = fit(stage);
  return chosen;
}

}  // namespace vkopple
