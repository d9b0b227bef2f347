#include "train/training_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

double norm(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += double{v} * double{v};
  return std::sqrt(sum);
}

/// Each process drops other values of its part.
uint32_t seed_of(uint32_t seed, const Peers* peers) {
  return several(peers) ? seed + 0x9e3779b9U * static_cast<uint32_t>(peers->rank()) : seed;
}

int part_of(int batch, const Peers* peers) {
  if (!several(peers)) return batch;
  if (batch % peers->count() != 0)
    throw Error(
        fmt::format("a batch of {} has no {} equal parts; start another number of processes, or give --batch",
                    batch, peers->count()));
  return batch / peers->count();
}

}  // namespace

TrainingStep::TrainingStep(const Device& device, const Config& config, const TrainingStage& stage,
                           std::shared_ptr<GroupStore> groups, bool profile, Peers* peers)
    : peers_(peers) {
  model_ = std::make_unique<Opple>(graph_, stage.model_in(config.model),
                                   OppleOptions{.batch = part_of(stage.batch, peers),
                                                .training = true,
                                                .background_only = stage.hypotheses == Hypotheses::kBackground,
                                                .precision = config.training.precision,
                                                .max_tensor_bytes = device.caps().max_tensor_bytes(),
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
  if (config.training.precision == Precision::kMixed) loss_scale_ = loss_scale(graph_, learning_, kLossScale);
  rate_ = learning_rate(graph_);
  for (size_t i = 0; i < networks.size(); ++i) {
    AdamOptions options{};
    options.beta1 = config.training.betas[0];
    options.beta2 = config.training.betas[1];
    options.epsilon = config.training.epsilon;
    options.clip = clip_of(config.training, networks[i]);
    adam(graph_, learning_[i], options, rate_, loss_scale_);
  }
  if (!config.training.sync_batch_norm)
    for (const auto& [group, members] : graph_.states())
      if (group.ends_with("/averages")) averages_.push_back(graph_.group(group));
  ExecutorOptions options{.groups = std::move(groups),
                          .loss = model_->loss(),
                          .trained = learning_,
                          .loss_scale = loss_scale_,
                          .profile = profile};
  if (several(peers)) {
    exchange_.emplace(*peers);
    // Where backward itself exchanges statistics, gradients wait for its end.
    exchanges_late_ = config.training.sync_batch_norm;
    if (!exchanges_late_) options.gradient_done = [this](const std::string& group) { begin_exchange(group); };
  }
  executor_ = std::make_unique<Executor>(device, graph_, std::move(options));
  // A store that has not been trained in mixed precision yet holds zeros.
  if (loss_scale_ && executor_->read(loss_scale_)[LossScale::kScale] == 0)
    executor_->write(loss_scale_, std::vector<float>{kLossScale.initial, 0, 0, 0});
  model_->feed_constants(*executor_);
  set_learning_rate(stage.learning_rate);
}

void TrainingStep::set_learning_rate(double rate) {
  if (rate == set_rate_) return;
  executor_->write(rate_, std::vector<float>{static_cast<float>(rate)});
  set_rate_ = rate;
}

Losses TrainingStep::run(const Triplets& triplets, uint32_t seed, uint32_t step, Trace* trace) {
  {
    const Trace::Span span(trace, "feed");
    model_->feed_random(*executor_, seed_of(seed, peers_), step);
    model_->feed(*executor_, triplets);
  }
  const double exchanged = several(peers_) ? peers_->seconds() : 0;
  executor_->forward();
  executor_->backward();
  if (several(peers_)) {
    const Trace::Span span(trace, "exchange");
    finish_gradients();
    average_over_peers(averages_);
  }
  executor_->update();
  if (loss_scale_) require_finite_gradients();
  Losses losses;
  {
    const Trace::Span span(trace, "read losses");
    losses = read_losses();
  }
  if (several(peers_)) exchange_seconds_ = peers_->seconds() - exchanged - exchange_->hidden_seconds();
  if (trace != nullptr)
    for (const PassProfile& pass : executor_->passes()) trace->add_pass(pass);
  return losses;
}

void TrainingStep::begin_exchange(const std::string& group) {
  exchange_->begin(group, executor_->read(graph_.gradient(group)));
}

void TrainingStep::finish_gradients() {
  if (exchanges_late_)
    for (const std::string& group : learning_) begin_exchange(group);
  for (const auto& [group, mean] : exchange_->finish()) executor_->write(graph_.gradient(group), mean);
}

void TrainingStep::average_over_peers(const std::vector<Value>& values) {
  for (const Value value : values) {
    std::vector<float> numbers = executor_->read(value);
    peers_->average(numbers);
    executor_->write(value, numbers);
  }
}

std::map<std::string, NetworkNorms> TrainingStep::norms() {
  const double factor = loss_scale_ ? executor_->read(loss_scale_)[LossScale::kFactor] : 1;
  std::map<std::string, NetworkNorms> norms;
  for (const std::string& group : learning_)
    norms[group] = {.weights = norm(executor_->read(graph_.group(group))),
                    .gradient = factor * norm(executor_->read(graph_.gradient(group)))};
  return norms;
}

Losses TrainingStep::read_losses() {
  std::vector<float> values;
  for (const auto& [name, value] : model_->losses()) values.push_back(executor_->read(value)[0]);
  if (several(peers_)) peers_->average(values);
  Losses losses;
  auto next = values.begin();
  for (const auto& [name, value] : model_->losses()) losses[name] = static_cast<double>(*next++);
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
