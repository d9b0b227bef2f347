#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "graph/parallel/peers.h"
#include "models/config.h"
#include "train/checkpoint.h"
#include "train/checkpoint_keeper.h"
#include "train/data/batch_part.h"
#include "train/data/triplets.h"
#include "train/model_store.h"
#include "train/profiler.h"
#include "train/run_folder.h"
#include "train/stage_plan.h"
#include "train/training_listener.h"
#include "train/training_log.h"
#include "train/training_memory.h"

namespace vkopple {

struct Triplets;

struct TrainerOptions {
  RunFolder folder;
  std::string data;                     ///< as open_triplets takes it
  std::filesystem::path checkpoint;     ///< that a resumed run goes on from; empty: the folder's latest
  std::filesystem::path weights;        ///< of a model, which a new run begins with; empty: random ones
  std::optional<uint64_t> steps;        ///< of the whole run; see StagePlan
  uint64_t seed = 0;                    ///< of weights, order, reversals, dropout
  uint64_t checkpoint_every = 5000;     ///< steps between numbered checkpoints; 0: none
  uint64_t keep = 0;                    ///< numbered checkpoints that stay, the last ones; 0: all
  uint64_t eval_every = 250;            ///< steps between measurements in held-out rooms; 0: none
  std::filesystem::path profile;        ///< where a trace (train/trace.h) goes; empty: none
  int profiled_steps = 1;               ///< of the trace, which leaves out the run's first step
  int data_threads = 2;                 ///< that read files ahead
  double seconds_between_saves = 600;   ///< after which latest.safetensors is written anyway
  uint64_t max_bad_steps = 10;          ///< that may be skipped in a row; at so many training stops
  FileSystem* files = &system_files();  ///< that checkpoints, log and events are written through
  Peers* peers = nullptr;               ///< processes that share the run; null: this one alone
  std::optional<uint64_t> free_memory;  ///< bytes of the device that may be taken; none: what it tells
};

/// What decides, in a run with these options, how much memory it takes.
TrainingSetting training_setting(const TrainerOptions& options);

/// Trains a model by docs/model.md §7 and the stages of its configuration, on a folder of checkpoints and log.
///
/// Every step is a function of configuration, seed, data and the checkpoint before, so that a run that was
/// stopped and resumed writes the same bytes as one that never was.
///
/// With peers all of them train the same weights, each on a part of every batch (train/training_step.h). The
/// process of rank 0 alone writes files, tells of progress and measures.
class Trainer {
 public:
  /// A new run; with `resume` one that goes on from a checkpoint, which must be of this configuration. Throws
  /// Error, also where the device has too little memory for what is to come, before it takes any.
  Trainer(const Device& device, Config config, TrainerOptions options, bool resume);
  ~Trainer();
  Trainer(const Trainer&) = delete;
  Trainer& operator=(const Trainer&) = delete;

  /// Trains until the plan's end, or until `stop` says so after a step, and saves. Whether it came to the end.
  /// On failure the checkpoints written before stay. Steps that are not finite are skipped and counted; Error
  /// with a diagnosis where there are too many in a row.
  bool run(TrainingListener& listener, const std::function<bool()>& stop);

  const TrainingPosition& position() const { return position_; }
  const StagePlan& plan() const { return plan_; }

 private:
  struct Stage;
  struct Diary;

  std::filesystem::path resumed_checkpoint() const;
  void require_memory_from(uint64_t step) const;
  Stage open_stage(const PlannedStage& planned);
  StepRecord train_step(Stage& stage, Trace* trace);
  Triplets triplets_of(Stage& stage, uint64_t step, int portion) const;
  void require_progress(Stage& stage) const;
  /// In held-out rooms, where it is time to.
  void measure(Stage& stage, Diary& diary, StepRecord& record);
  bool leads() const { return options_.peers == nullptr || options_.peers->rank() == 0; }
  BatchPart part() const;
  SharedStep shared(double waited, double seconds);
  void save(bool numbered);
  void save_if_due();

  const Device* device_;
  Config config_;
  TrainerOptions options_;
  StagePlan plan_;
  ModelStore store_;
  TrainingPosition position_;
  CheckpointKeeper keeper_;
  std::optional<uint64_t> saved_step_;  ///< of latest.safetensors
  std::chrono::steady_clock::time_point saved_at_;
  std::optional<Profiler> profiler_;
};

}  // namespace vkopple
