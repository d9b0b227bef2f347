#include "train/training_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "graph/ops/loss_scale.h"
#include "runtime/device.h"
#include "train/trace.h"

namespace vkopple {
namespace {

constexpr LossScaleOptions kLossScale{};

bool are_finite(const Losses& losses) {
  return std::all_of(losses.begin(), losses.end(), [](const auto& item) { return std::isfinite(item.second); });
}

double norm(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += double{v} * double{v};
  return std::sqrt(sum);
}

/// Each portion of each process drops other values.
uint32_t seed_of(uint32_t seed, int portion, const Peers* peers) {
  const int index = several(peers) ? portion * peers->count() + peers->rank() : portion;
  return seed + 0x9e3779b9U * static_cast<uint32_t>(index);
}

}  // namespace

TrainingStep::TrainingStep(const Device& device, const Config& config, const TrainingStage& stage,
                           std::shared_ptr<GroupStore> groups, bool profile, Peers* peers)
    : peers_(peers), step_(device.caps(), config, stage, peers) {
  if (!config.training.sync_batch_norm)
    for (const std::string& group : step_.averages()) averages_.push_back(graph().group(group));
  ExecutorOptions options = step_.executor_options();
  options.groups = std::move(groups);
  options.profile = profile;
  if (several(peers)) {
    exchange_.emplace(*peers);
    // Where backward itself exchanges statistics, gradients wait for its end.
    exchanges_late_ = config.training.sync_batch_norm;
    if (!exchanges_late_)
      options.gradient_done = [this](const std::string& group) {
        if (last_portion_) begin_exchange(group);
      };
  }
  executor_ = std::make_unique<Executor>(device, graph(), std::move(options));
  // A store that has not been trained in mixed precision yet holds zeros.
  const Value scale = step_.loss_scale();
  if (scale && executor_->read(scale)[LossScale::kScale] == 0)
    executor_->write(scale, std::vector<float>{kLossScale.initial, 0, 0, 0});
  prepare_checks(device);
  model().feed_constants(*executor_);
  set_learning_rate(stage.learning_rate);
}

void TrainingStep::prepare_checks(const Device& device) {
  std::vector<Slice> averages;
  for (const std::string& group : step_.averages()) averages.push_back(executor_->slice(graph().group(group)));
  averages_before_.emplace(device, averages);
  std::vector<Slice> checked = averages;
  // Those of a scaled loss are looked at, and may overflow, where the scale is adapted.
  if (!step_.loss_scale())
    for (const std::string& group : step_.learning())
      checked.push_back(executor_->slice(graph().gradient(group)));
  check_.emplace(device, checked);
}

void TrainingStep::set_learning_rate(double rate) {
  if (rate == set_rate_) return;
  executor_->write(step_.rate(), std::vector<float>{static_cast<float>(rate)});
  set_rate_ = rate;
}

void TrainingStep::feed(const Triplets& triplets, uint32_t seed, uint32_t step, int portion) {
  model().feed_random(*executor_, seed_of(seed, portion, peers_), step);
  model().feed(*executor_, triplets);
}

void TrainingStep::run_portion(int portion, Trace* trace) {
  last_portion_ = portion + 1 == step_.portions();
  executor_->forward();
  executor_->backward(portion == 0 ? Portion::kFirst : Portion::kLater);
  if (trace == nullptr) return;
  trace->add_pass(executor_->pass(Pass::kForward));
  trace->add_pass(executor_->pass(Pass::kBackward));
}

Losses TrainingStep::run(const TripletsOfPortion& triplets_of, uint32_t seed, uint32_t step, Trace* trace) {
  const double exchanged = several(peers_) ? peers_->seconds() : 0;
  averages_before_->keep();
  std::vector<double> losses(model().losses().size());
  for (int portion = 0; portion < step_.portions(); ++portion) {
    const Triplets triplets = triplets_of(portion);
    {
      const Trace::Span span(trace, "feed");
      feed(triplets, seed, step, portion);
    }
    run_portion(portion, trace);
    const Trace::Span span(trace, "read losses");
    const std::vector<float> values = read_losses();
    for (size_t i = 0; i < values.size(); ++i) losses[i] += double{values[i]};
  }
  if (several(peers_)) {
    const Trace::Span span(trace, "exchange");
    finish_gradients();
    average_over_peers(averages_);
  }
  const Losses means = mean_losses(std::move(losses));
  update_unless_bad(means);
  if (several(peers_)) exchange_seconds_ = peers_->seconds() - exchanged - exchange_->hidden_seconds();
  if (trace != nullptr && !skipped_)  // of a pass that never ran there are no times
    trace->add_pass(executor_->pass(Pass::kUpdate));
  return means;
}

void TrainingStep::begin_exchange(const std::string& group) {
  exchange_->begin(group, executor_->read(graph().gradient(group)));
}

void TrainingStep::finish_gradients() {
  if (exchanges_late_)
    for (const std::string& group : step_.learning()) begin_exchange(group);
  for (const auto& [group, mean] : exchange_->finish()) executor_->write(graph().gradient(group), mean);
}

void TrainingStep::average_over_peers(const std::vector<Value>& values) {
  for (const Value value : values) {
    std::vector<float> numbers = executor_->read(value);
    peers_->average(numbers);
    executor_->write(value, numbers);
  }
}

std::map<std::string, NetworkNorms> TrainingStep::norms() {
  const Value scale = step_.loss_scale();
  const double factor = scale ? executor_->read(scale)[LossScale::kFactor] : 1;
  std::map<std::string, NetworkNorms> norms;
  for (const std::string& group : step_.learning())
    norms[group] = {.weights = norm(executor_->read(graph().group(group))),
                    .gradient = factor * norm(executor_->read(graph().gradient(group)))};
  return norms;
}

std::vector<float> TrainingStep::read_losses() const {
  std::vector<float> values;
  for (const auto& [name, value] : model().losses()) values.push_back(executor_->read(value)[0]);
  return values;
}

/// `sums` over portions, of this process.
Losses TrainingStep::mean_losses(std::vector<double> sums) {
  std::vector<float> values;
  for (const double sum : sums) values.push_back(static_cast<float>(sum / step_.portions()));
  if (several(peers_)) peers_->average(values);
  Losses losses;
  auto next = values.begin();
  for (const auto& [name, value] : model().losses()) losses[name] = static_cast<double>(*next++);
  return losses;
}

/// Every process comes to the same: all have the same losses, gradients and averages by now.
void TrainingStep::update_unless_bad(const Losses& losses) {
  skipped_ = !are_finite(losses) || !check_->all_finite();
  if (!skipped_) {
    executor_->update();
    skipped_ = overflowed_at_smallest_scale();
  }
  if (skipped_) averages_before_->restore();
}

/// Halving the scale has an end: gradients that are not finite even so are no matter of float16.
bool TrainingStep::overflowed_at_smallest_scale() const {
  if (!step_.loss_scale()) return false;
  const auto state = executor_->read(step_.loss_scale());
  return state[LossScale::kFactor] == 0 && state[LossScale::kScale] == kLossScale.smallest;
}

std::string TrainingStep::diagnosis(const TripletsOfPortion& triplets_of, uint32_t seed, uint32_t step) {
  std::string found;
  // All portions, whatever is found: peers wait for each other in every one.
  for (int portion = 0; portion < step_.portions(); ++portion) {
    feed(triplets_of(portion), seed, step, portion);
    const auto here = executor_->find_not_finite();
    if (!here || !found.empty()) continue;
    found = "the first that gave a number that is not finite was " + *here;
    if (step_.portions() > 1) found += fmt::format(", portion {} of {}", portion + 1, step_.portions());
  }
  averages_before_->restore();
  if (!found.empty()) return found;
  return several(peers_) ? "in this process everything was finite" : "run again, everything was finite";
}

}  // namespace vkopple
