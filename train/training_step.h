#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "graph/finite_check.h"
#include "graph/state_backup.h"
#include "models/config.h"
#include "models/opple.h"
#include "train/parallel/gradient_exchange.h"
#include "train/step_graph.h"
#include "train/step_record.h"

namespace vkopple {

class Device;
class Trace;

/// The triplets of one of a step's portions (of this process), by its number; asked for one after the other.
using TripletsOfPortion = std::function<Triplets(int portion)>;

/// The training step of one stage on a device, by the stage's graph (train/step_graph.h). In mixed precision
/// the loss is scaled, and a step whose gradients overflow changes nothing but the scale
/// (graph/ops/loss_scale.h). A step of which a loss, a gradient or a running average is not finite, however the
/// loss is scaled, is skipped: it changes nothing. Weights, averages and optimiser state live in `groups`,
/// which stages share.
///
/// A batch may be worked off in portions (TrainingStage::accumulate): losses and gradients are the means of
/// theirs, and so those of the whole batch but for rounding, for dropout's masks, for what joins scenes of a
/// batch, which are then those of a portion, and for statistics of batch norms, which are each portion's own;
/// these move the running averages one after the other.
///
/// With peers each process takes its part of the stage's batch, and gradients, losses and running averages are
/// the means over all: what one process would get of the whole batch, but for rounding, for dropout's masks,
/// and for statistics of batch norms, which are each part's own unless the configuration says sync_batch_norm
/// (docs/parallel.md).
class TrainingStep {
 public:
  TrainingStep(const Device& device, const Config& config, const TrainingStage& stage,
               std::shared_ptr<GroupStore> groups, bool profile = false, Peers* peers = nullptr);

  const Opple& model() const { return step_.model(); }
  Graph& graph() { return step_.graph(); }
  Executor& executor() { return *executor_; }
  /// Of the last run: seconds that this process waited in exchanges with its peers.
  double exchange_seconds() const { return exchange_seconds_; }
  /// Triplets of a portion.
  int64_t batch() const { return model().options().batch; }

  /// Whether the last run was skipped.
  bool skipped() const { return skipped_; }
  /// Of the last run, which was skipped and had these arguments: what was first to be not finite, in words.
  /// Slow. All processes must call it together.
  std::string diagnosis(const TripletsOfPortion& triplets_of, uint32_t seed, uint32_t step);

  /// Of the runs that follow; the stage's until then.
  void set_learning_rate(double rate);

  /// Forward and backward on each portion of a batch (of this process), and one update; `step` counts from 0
  /// and numbers the dropout masks. Losses by name. A step that was made for profiling tells `trace` what it
  /// did.
  Losses run(const TripletsOfPortion& triplets_of, uint32_t seed, uint32_t step, Trace* trace = nullptr);
  /// The same where the batch is one portion.
  Losses run(const Triplets& triplets, uint32_t seed, uint32_t step, Trace* trace = nullptr) {
    return run([&](int) { return triplets; }, seed, step, trace);
  }

  /// Of the networks that learn, by name: the weights' as they are now, the gradient's of the last run, without
  /// loss scaling. Reads all of them.
  std::map<std::string, NetworkNorms> norms();

 private:
  void feed(const Triplets& triplets, uint32_t seed, uint32_t step, int portion);
  void run_portion(int portion, Trace* trace);
  void begin_exchange(const std::string& group);
  void finish_gradients();
  void average_over_peers(const std::vector<Value>& values);
  std::vector<float> read_losses() const;
  Losses mean_losses(std::vector<double> sums);
  void prepare_checks(const Device& device);
  void update_unless_bad(const Losses& losses);
  bool overflowed_at_smallest_scale() const;

  Peers* peers_;
  StepGraph step_;
  std::vector<Value> averages_;  ///< running ones that processes have of their own batches
  double set_rate_ = -1;         ///< what the learning rate is
  std::optional<GradientExchange> exchange_;
  bool exchanges_late_ = false;  ///< gradients are exchanged after backward, not during it
  bool last_portion_ = false;    ///< of the step under way, whose gradients are complete then
  double exchange_seconds_ = 0;
  std::unique_ptr<Executor> executor_;
  std::optional<StateBackup> averages_before_;  ///< of the last run
  std::optional<FiniteCheck> check_;  ///< of running averages and, unless the loss is scaled, gradients
  bool skipped_ = false;
};

}  // namespace vkopple
