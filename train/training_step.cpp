#include "train/training_step.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/ops/adam.h"
#include "graph/ops/loss_scale.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "train/trace.h"

namespace vkopple {
namespace {

constexpr LossScaleOptions kLossScale{};

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

TrainingStep::TrainingStep(const Device& device, const Config& config, const TrainingStage& stage,
                           std::shared_ptr<GroupStore> groups, bool profile) {
  model_ = std::make_unique<Opple>(graph_, config.model,
                                   OppleOptions{.batch = stage.batch,
                                                .training = true,
                                                .background_only = stage.hypotheses == Hypotheses::kBackground,
                                                .precision = config.training.precision,
                                                .max_tensor_bytes = device.caps().max_tensor_bytes()});
  const auto present = model_->groups();
  std::vector<Network> networks;
  std::vector<std::string> trained;
  for (const Network network : stage.networks) {
    const std::string group(kNetworkNames[static_cast<size_t>(network)]);
    if (std::find(present.begin(), present.end(), group) == present.end()) continue;
    networks.push_back(network);
    trained.push_back(group);
  }
  if (config.training.precision == Precision::kMixed) loss_scale_ = loss_scale(graph_, trained, kLossScale);
  for (size_t i = 0; i < networks.size(); ++i) {
    AdamOptions options{};
    options.learning_rate = stage.learning_rate;
    options.beta1 = config.training.betas[0];
    options.beta2 = config.training.betas[1];
    options.epsilon = config.training.epsilon;
    options.clip = clip_of(config.training, networks[i]);
    adam(graph_, trained[i], options, loss_scale_);
  }
  executor_ = std::make_unique<Executor>(device, graph_,
                                         ExecutorOptions{.groups = std::move(groups),
                                                         .loss = model_->loss(),
                                                         .trained = trained,
                                                         .loss_scale = loss_scale_,
                                                         .profile = profile});
  // A store that has not been trained in mixed precision yet holds zeros.
  if (loss_scale_ && executor_->read(loss_scale_)[LossScale::kScale] == 0)
    executor_->write(loss_scale_, std::vector<float>{kLossScale.initial, 0, 0, 0});
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
  if (loss_scale_) require_finite_gradients();
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

/// Halving the scale has an end: gradients that are not finite even so are no matter of float16.
void TrainingStep::require_finite_gradients() const {
  const auto state = executor_->read(loss_scale_);
  if (state[LossScale::kFactor] == 0 && state[LossScale::kScale] == kLossScale.smallest)
    throw Error(
        fmt::format("gradients are not finite however little the loss is scaled, {} steps were skipped; try a "
                    "smaller learning rate, or --precision float32",
                    state[LossScale::kSkipped]));
}

}  // namespace vkopple
