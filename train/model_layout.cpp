#include "train/model_layout.h"

#include <string_view>

#include "graph/graph.h"
#include "graph/ops/adam.h"
#include "graph/ops/loss_scale.h"
#include "models/opple.h"

namespace vkopple {
namespace {

constexpr std::string_view kMean = "running_mean";
constexpr int64_t kFrames = 3;

}  // namespace

ModelLayout::ModelLayout(const ModelConfig& config, Precision precision)
    : frames_seen_(config.statistics_frames == StatisticsFrames::kAll ? kFrames : 1) {
  Graph graph;
  const Opple model(graph, config, {.batch = 1, .training = true});
  add_weights(graph, model);
  const Value rate = learning_rate(graph);
  for (const std::string& network : model.groups()) add_optimiser(graph, network, rate);
  if (precision == Precision::kMixed) add_loss_scale(graph, model.groups());
}

void ModelLayout::add_weights(Graph& graph, const Opple& model) {
  for (const InitialTensor& tensor : model.tensors()) {
    const ValueInfo& info = graph.info(tensor.value.id());
    const ValueInfo& root = graph.info(info.root);
    weights_.push_back({tensor.name, root.name, info.offset, info.spec.shape, tensor.initial});
    groups_[root.name] = root.spec.bytes();
    if (tensor.name.ends_with(kMean))
      batch_counters_.push_back(tensor.name.substr(0, tensor.name.size() - kMean.size()) +
                                "num_batches_tracked");
  }
}

void ModelLayout::add_optimiser(Graph& graph, const std::string& network, Value rate) {
  adam(graph, network, {}, rate);
  const std::string state = "adam/" + network;
  groups_[state] = graph.group(state).spec().bytes();
  const auto offset = [&](const std::string& name) { return graph.info(graph.find(name).id()).offset; };
  // The means lie like the parameters.
  for (const char* mean : {"/m", "/v"}) {
    const std::string prefix = state + mean;
    for (const LayoutEntry& weight : weights_) {
      if (weight.group != network) continue;
      optimiser_.push_back({prefix + "/" + weight.name, state, offset(prefix) + weight.offset, weight.shape,
                            Initial::constant(0)});
    }
  }
  const std::string correction = state + "/correction";
  optimiser_.push_back(
      {correction, state, offset(correction), graph.find(correction).shape(), Initial::constant(0)});
}

void ModelLayout::add_loss_scale(Graph& graph, const std::vector<std::string>& networks) {
  const Value state = loss_scale(graph, networks);
  groups_[kLossScaleGroup] = graph.group(kLossScaleGroup).spec().bytes();
  optimiser_.push_back(
      {kLossScaleState, kLossScaleGroup, graph.info(state.id()).offset, state.shape(), Initial::constant(0)});
}

int64_t ModelLayout::calls_in_a_step(const std::string& counter, bool background_only, int slots) const {
  const bool depth = counter.starts_with("depth_model.");
  if (background_only) return depth ? 1 : 0;
  const bool decoder = counter.find("_att.") != std::string::npos;
  if (decoder) return frames_seen_ * slots;
  return depth ? frames_seen_ : kFrames;
}

}  // namespace vkopple
