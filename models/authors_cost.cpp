#include "models/authors_cost.h"

#include <vector>

#include "graph/autodiff.h"
#include "models/opple.h"
#include "runtime/caps.h"

namespace vkopple {
namespace {

/// How often the authors compute a value that is here computed once and then added to every slot's.
std::vector<int64_t> repetitions(const Graph& graph) {
  std::vector<int64_t> times(graph.value_count(), 1);
  for (const Node& node : graph.nodes()) {
    if (node.op->name() != "add_repeated") continue;
    const auto samples = [&](int id) { return graph.info(id).spec.shape[0]; };
    times[static_cast<size_t>(node.inputs[1])] = samples(node.inputs[0]) / samples(node.inputs[1]);
  }
  return times;
}

}  // namespace

double authors_flop(const ModelConfig& config) {
  ModelConfig authors = config;
  authors.statistics_frames = StatisticsFrames::kAll;
  Graph graph;
  const Opple model(graph, authors, {.batch = 1, .training = true});
  const auto times = repetitions(graph);
  std::vector<Needs> needs;
  double sum = 0;
  const auto of = [&](const Node& node, double flop) {
    return flop * static_cast<double>(times[static_cast<size_t>(node.outputs[0])]);
  };
  for (const Node& node : graph.nodes()) {
    std::vector<TensorSpec> inputs;
    for (int id : node.inputs) inputs.push_back(graph.info(id).spec);
    needs.push_back(node.op->needs(inputs, Caps{}));
    sum += of(node, needs.back().forward_flop);
  }
  for (const BackwardStep& step : plan_backward(graph, model.loss(), model.groups()).steps) {
    const Node& node = graph.nodes()[step.node];
    sum += of(node, backward_flop(node, step, needs[step.node].backward_flop));
  }
  return sum;
}

}  // namespace vkopple
