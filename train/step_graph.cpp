#include "train/step_graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/ops/adam.h"
#include "graph/ops/loss_scale.h"
#include "runtime/caps.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

double clip_of(const TrainingConfig& training, Network network) {
  switch (network) {
    case Network::kDepth:
      return training.clip.depth;
    case Network::kObject:
      return training.clip.object;
    case Network::kImagination:
      return training.clip.imagination;
    case Network::kMotion:
      return training.clip.motion;
  }
  return training.clip.object;
}

}  // namespace

int portion_batch(const TrainingStage& stage, const Peers* peers) {
  const int processes = several(peers) ? peers->count() : 1;
  if (stage.batch % processes != 0)
    throw Error(
        fmt::format("a batch of {} has no {} equal parts; start another number of processes, or give --batch",
                    stage.batch, processes));
  const int part = stage.batch / processes;
  if (part % stage.accumulate != 0)
    throw Error(fmt::format(
        "stage {}: {} triplets of a step have no {} equal portions; give --accumulate a number that divides {}",
        stage.name, part, stage.accumulate, part));
  return part / stage.accumulate;
}

StepGraph::StepGraph(const Caps& caps, const Config& config, const TrainingStage& stage, Peers* peers)
    : portions_(stage.accumulate) {
  model_ = std::make_unique<Opple>(graph_, stage.model_in(config.model),
                                   OppleOptions{.batch = portion_batch(stage, peers),
                                                .training = true,
                                                .background_only = stage.hypotheses == Hypotheses::kBackground,
                                                .precision = config.training.precision,
                                                .max_tensor_bytes = caps.max_tensor_bytes(),
                                                .peers = peers,
                                                .sync_batch_norm = config.training.sync_batch_norm});
  const auto present = model_->groups();
  std::vector<Network> networks;
  for (const Network network : stage.networks) {
    const std::string group(kNetworkNames[static_cast<size_t>(network)]);
    if (std::find(present.begin(), present.end(), group) == present.end()) continue;
    networks.push_back(network);
    learning_.push_back(group);
  }
  if (config.training.precision == Precision::kMixed) loss_scale_ = vkopple::loss_scale(graph_, learning_);
  rate_ = learning_rate(graph_);
  for (size_t i = 0; i < networks.size(); ++i) {
    AdamOptions options{};
    options.beta1 = config.training.betas[0];
    options.beta2 = config.training.betas[1];
    options.epsilon = config.training.epsilon;
    options.clip = clip_of(config.training, networks[i]);
    adam(graph_, learning_[i], options, rate_, loss_scale_);
  }
  for (const auto& [group, members] : graph_.states())
    if (group.ends_with("/averages")) averages_.push_back(group);
}

ExecutorOptions StepGraph::executor_options() const {
  return {.loss = model_->loss(), .trained = learning_, .loss_scale = loss_scale_, .portions = portions_};
}

}  // namespace vkopple
