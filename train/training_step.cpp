#include "train/training_step.h"

#include <algorithm>

#include "graph/ops/adam.h"
#include "runtime/device.h"
#include "train/trace.h"

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
  }
  return training.clip.object;
}

}  // namespace

TrainingStep::TrainingStep(const Device& device, const Config& config, const TrainingStage& stage,
                           std::shared_ptr<GroupStore> groups, bool profile) {
  model_ = std::make_unique<Opple>(graph_, config.model,
                                   OppleOptions{.batch = stage.batch,
                                                .training = true,
                                                .background_only = stage.hypotheses == Hypotheses::kBackground,
                                                .max_tensor_bytes = device.caps().max_tensor_bytes()});
  const auto present = model_->groups();
  std::vector<std::string> trained;
  for (const Network network : stage.networks) {
    const std::string group(kNetworkNames[static_cast<size_t>(network)]);
    if (std::find(present.begin(), present.end(), group) == present.end()) continue;
    AdamOptions options{};
    options.learning_rate = stage.learning_rate;
    options.beta1 = config.training.betas[0];
    options.beta2 = config.training.betas[1];
    options.epsilon = config.training.epsilon;
    options.clip = clip_of(config.training, network);
    adam(graph_, group, options);
    trained.push_back(group);
  }
  executor_ = std::make_unique<Executor>(
      device, graph_,
      ExecutorOptions{
          .groups = std::move(groups), .loss = model_->loss(), .trained = trained, .profile = profile});
  model_->feed_constants(*executor_);
}

std::map<std::string, double> TrainingStep::run(const Triplets& triplets, uint32_t seed, uint32_t step,
                                                Trace* trace) {
  {
    const Trace::Span span(trace, "feed");
    model_->feed_random(*executor_, seed, step);
    model_->feed(*executor_, triplets);
  }
  executor_->forward();
  executor_->backward();
  executor_->update();
  std::map<std::string, double> losses;
  {
    const Trace::Span span(trace, "read losses");
    for (const auto& [name, value] : model_->losses())
      losses[name] = static_cast<double>(executor_->read(value)[0]);
  }
  if (trace != nullptr)
    for (const PassProfile& pass : executor_->passes()) trace->add_pass(pass);
  return losses;
}

}  // namespace vkopple
