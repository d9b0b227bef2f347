#include "graph/execution_plan.h"

#include "runtime/arena_blocks.h"
#include "runtime/caps.h"

namespace vkopple {

ExecutionPlan plan_execution(const Caps& caps, Graph& graph, const ExecutorOptions& options) {
  ExecutionPlan plan;
  if (options.loss) plan.backward = plan_backward(graph, options.loss, options.trained);
  for (const Node& node : graph.nodes()) {
    std::vector<TensorSpec> specs;
    for (int id : node.inputs) specs.push_back(stored_as(graph.info(id).spec, Storage::kFloat32));
    plan.needs.push_back(node.op->needs(specs, caps));
  }
  plan.recomputation = plan_recomputation(graph, plan.backward, plan.needs, options.recompute_from);
  plan.layout =
      lay_out(graph, options.loss, plan.backward, plan.recomputation, plan.needs, caps, options.in_place);
  ArenaBlocks kept(caps, kKeptBlockBytes);
  for (size_t id = 0; id < graph.value_count(); ++id) {
    const ValueInfo& info = graph.info(static_cast<int>(id));
    if (info.root != static_cast<int>(id) || !has_own_memory(info)) continue;
    if (in_group(info))
      plan.groups[info.name] = info.spec.bytes();
    else
      kept.add(info.spec.bytes());
  }
  plan.kept_bytes = kept.total_bytes();
  return plan;
}

uint64_t group_store_bytes(const Caps& caps, const std::map<std::string, uint64_t>& groups) {
  ArenaBlocks blocks(caps, kGroupBlockBytes);
  for (const auto& [name, bytes] : groups) blocks.add(bytes);
  return blocks.total_bytes();
}

}  // namespace vkopple
