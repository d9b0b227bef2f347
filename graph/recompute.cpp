#include "graph/recompute.h"

#include <algorithm>
#include <optional>

namespace vkopple {
namespace {

class Search {
 public:
  Search(const Graph& graph, const BackwardPlan& backward, std::span<const Needs> needs)
      : graph_(graph), needs_(needs), uses_(graph.value_count()), producer_(graph.value_count(), -1) {
    plan_.before.resize(backward.steps.size());
    plan_.first.assign(graph.value_count(), -1);
    std::vector<uint8_t> has_step(graph.nodes().size());
    for (size_t s = 0; s < backward.steps.size(); ++s) {
      has_step[backward.steps[s].node] = 1;
      follow(backward.steps[s].node, static_cast<int64_t>(s));
    }
    for (size_t n = 0; n < graph.nodes().size(); ++n)
      if (can_run_again(n, has_step[n] != 0))
        producer_[index(graph.nodes()[n].outputs[0])] = static_cast<int64_t>(n);
  }

  Recomputation run(uint64_t least_bytes) {
    // In forward order: what a node reads is decided before the node.
    for (const Node& node : graph_.nodes()) {
      if (node.outputs.size() != 1) continue;
      const int value = node.outputs[0];
      const Uses& uses = uses_[index(value)];
      if (producer_[index(value)] < 0 || uses.first < 0) continue;
      const uint64_t bytes = graph_.info(value).spec.bytes();
      const auto early = early_bytes(value, uses.first);
      if (bytes >= least_bytes && early && *early < bytes) demand(value, uses.first);
    }
    for (size_t root = 0; root < plan_.first.size(); ++root)
      if (plan_.first[root] >= 0)
        plan_.before[static_cast<size_t>(plan_.first[root])].push_back(static_cast<size_t>(producer_[root]));
    for (auto& nodes : plan_.before) std::sort(nodes.begin(), nodes.end());
    return std::move(plan_);
  }

 private:
  /// Backward steps that read a root, as forward left it.
  struct Uses {
    int64_t first = -1;
    int64_t last = -1;
  };

  size_t index(int value) const { return static_cast<size_t>(graph_.info(value).root); }

  void follow(size_t n, int64_t step) {
    const Node& node = graph_.nodes()[n];
    const auto use = [&](const std::vector<int>& values, uint32_t mask) {
      for (size_t i = 0; i < values.size(); ++i) {
        if (!in_mask(mask, i)) continue;
        Uses& uses = uses_[index(values[i])];
        if (uses.first < 0) uses.first = step;
        uses.last = step;
      }
    };
    use(node.inputs, needs_[n].inputs_for_backward);
    use(node.outputs, needs_[n].outputs_for_backward);
  }

  bool can_run_again(size_t n, bool has_step) const {
    const Node& node = graph_.nodes()[n];
    if (!node.op->recomputes() || node.outputs.size() != 1) return false;
    if (!needs_[n].saved.empty() && !has_step) return false;
    const ValueInfo& output = graph_.info(node.outputs[0]);
    return output.root == node.outputs[0] && output.role == Role::kIntermediate && !output.kept;
  }

  /// Bytes that would have to be made before their own first reader and kept until then, for the value to be
  /// made before `step`; nothing where it can't be made.
  std::optional<uint64_t> early_bytes(int value, int64_t step) const {
    uint64_t sum = 0;
    for (int input : graph_.nodes()[static_cast<size_t>(producer_[index(value)])].inputs) {
      if (there(input, step) || made_by(input, step)) continue;
      if (producer_[index(input)] < 0) return std::nullopt;
      const auto below = early_bytes(input, step);
      if (!below) return std::nullopt;
      const bool read_later = plan_.again(graph_.info(input).root) || uses_[index(input)].first >= 0;
      sum += *below + (read_later ? graph_.info(graph_.info(input).root).spec.bytes() : 0);
    }
    return sum;
  }

  bool made_by(int value, int64_t step) const {
    const int64_t first = plan_.first[index(value)];
    return first >= 0 && first <= step;
  }

  /// Whether forward's own copy is still there.
  bool there(int value, int64_t step) const {
    const ValueInfo& root = graph_.info(graph_.info(value).root);
    if (root.role != Role::kIntermediate || root.kept) return true;
    return !plan_.again(graph_.info(value).root) && uses_[index(value)].last >= step;
  }

  void demand(int value, int64_t step) {
    if (made_by(value, step)) return;
    plan_.first[index(value)] = step;
    for (int input : graph_.nodes()[static_cast<size_t>(producer_[index(value)])].inputs)
      if (!there(input, step)) demand(input, step);
  }

  const Graph& graph_;
  std::span<const Needs> needs_;
  std::vector<Uses> uses_;         ///< by root
  std::vector<int64_t> producer_;  ///< by root: the node that can make it again, or -1
  Recomputation plan_;
};

}  // namespace

Recomputation plan_recomputation(const Graph& graph, const BackwardPlan& backward, std::span<const Needs> needs,
                                 uint64_t least_bytes) {
  return Search(graph, backward, needs).run(least_bytes);
}

}  // namespace vkopple
