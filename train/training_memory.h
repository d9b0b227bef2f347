#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/parallel/peers.h"
#include "models/config.h"
#include "train/stage_plan.h"

namespace vkopple {

struct Caps;

/// What, beside a configuration, decides how much memory training takes.
struct TrainingSetting {
  bool drawn = true;       ///< rooms are drawn on the device
  bool measured = true;    ///< this process measures in held-out rooms
  Peers* peers = nullptr;  ///< null: this process alone
};

/// Images that a stage measures at once in held-out rooms.
int probe_batch(const TrainingStage& stage);

/// Bytes of device memory that a stage of training takes while it lasts, in this process: weights, gradients,
/// optimiser, activations, images. Without what drivers take for themselves. Needs no device. Throws Error as
/// portion_batch() does.
uint64_t stage_bytes(const Caps& caps, const Config& config, const TrainingStage& stage,
                     const TrainingSetting& setting);

/// Throws Error where one of the stages takes more than `free` bytes, which says how much is needed and, unless
/// the run is `resumed` and so keeps its batch, what would fit.
void require_memory(const Caps& caps, const Config& config, const std::vector<PlannedStage>& stages,
                    const TrainingSetting& setting, uint64_t free, bool resumed);

/// Of `free` bytes those that fit_memory() has training take: nine tenths, and of a CPU's memory half a GiB
/// less, in which kernels are compiled.
uint64_t fitting_bytes(const Caps& caps, uint64_t free);

/// Has every stage work off its batch in the fewest equal portions (TrainingStage::accumulate) with which it
/// takes no more than fitting_bytes(caps, free) in any process, and gives a line for each that tells what was
/// chosen. Throws Error where even single triplets take more.
std::vector<std::string> fit_memory(const Caps& caps, Config& config, const TrainingSetting& setting,
                                    uint64_t free);

}  // namespace vkopple
