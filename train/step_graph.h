#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graph/executor.h"
#include "graph/graph.h"
#include "graph/parallel/peers.h"
#include "models/config.h"
#include "models/opple.h"

namespace vkopple {

/// Triplets that a stage's graph takes at once: the batch shared out among processes, each one's part among its
/// portions. `peers` may be null. Throws Error where there are no equal parts.
int portion_batch(const TrainingStage& stage, const Peers* peers);

/// The graph of a stage's training step: the model for the stage's networks and hypotheses, with Adam for the
/// networks that learn, and in mixed precision the scale of the loss. Needs no device.
class StepGraph {
 public:
  /// `peers` may be null. Throws Error as portion_batch does.
  StepGraph(const Caps& caps, const Config& config, const TrainingStage& stage, Peers* peers);

  Graph& graph() { return graph_; }
  const Opple& model() const { return *model_; }
  /// Groups of the networks that learn.
  const std::vector<std::string>& learning() const { return learning_; }
  /// Groups of running averages.
  const std::vector<std::string>& averages() const { return averages_; }
  Value rate() const { return rate_; }              ///< of learning
  Value loss_scale() const { return loss_scale_; }  ///< the state of LossScale, in mixed precision
  int portions() const { return portions_; }

  /// As an executor needs them, which has groups of its own until it is given some.
  ExecutorOptions executor_options() const;

 private:
  Graph graph_;
  std::unique_ptr<Opple> model_;
  std::vector<std::string> learning_;
  std::vector<std::string> averages_;
  Value rate_;
  Value loss_scale_;
  int portions_;
};

}  // namespace vkopple
