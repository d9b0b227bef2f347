#pragma once

#include <map>
#include <memory>
#include <string>

#include "models/config.h"
#include "models/opple.h"

namespace vkopple {

class Device;
class Trace;

/// The training step of one stage on a device: the model's graph for the stage's networks and hypotheses, with
/// Adam for the networks that learn. In mixed precision the loss is scaled, and a step whose gradients overflow
/// changes nothing but the scale (graph/ops/loss_scale.h). Weights, averages and optimiser state live in
/// `groups`, which stages share.
class TrainingStep {
 public:
  TrainingStep(const Device& device, const Config& config, const TrainingStage& stage,
               std::shared_ptr<GroupStore> groups, bool profile = false);

  const Opple& model() const { return *model_; }
  Graph& graph() { return graph_; }
  Executor& executor() { return *executor_; }
  int64_t batch() const { return model_->options().batch; }

  /// Forward, backward, update on one batch; `step` counts from 0 and numbers the dropout masks. Losses by
  /// name. A step that was made for profiling tells `trace` what it did.
  std::map<std::string, double> run(const Triplets& triplets, uint32_t seed, uint32_t step,
                                    Trace* trace = nullptr);

 private:
  void require_finite_gradients() const;

  Graph graph_;
  std::unique_ptr<Opple> model_;
  Value loss_scale_;  ///< the state of LossScale, in mixed precision
  std::unique_ptr<Executor> executor_;
};

}  // namespace vkopple
