#include "graph/autodiff.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/error.h"

namespace vkopple {
namespace {

class Walk {
 public:
  Walk(Graph& graph, const std::vector<std::string>& trained)
      : graph_(graph),
        requires_(graph.value_count()),
        has_(graph.value_count()),
        partial_(graph.value_count()) {
    for (const auto& name : trained) {
      const int root = graph.group(name).id();
      mark(requires_, root);
      mark(has_, root);
      plan_.zero_first.push_back(root);
    }
    for (const Node& node : graph.nodes()) {
      bool any = false;
      for (size_t i = 0; i < node.inputs.size(); ++i)
        any = any || (node.op->differentiable(i) && at(requires_, root_of(node.inputs[i])));
      for (int id : node.outputs)
        if (any) mark(requires_, root_of(id));
      note_views(node.inputs);
      note_views(node.outputs);
    }
  }

  BackwardPlan run(Value loss) {
    const int root = root_of(loss.id());
    if (!at(requires_, root)) throw Error("the loss depends on none of the trained parameters");
    mark(has_, root);
    for (size_t n = graph_.nodes().size(); n-- > 0;) visit(n);
    return std::move(plan_);
  }

 private:
  static bool at(const std::vector<uint8_t>& flags, int id) { return flags[static_cast<size_t>(id)] != 0; }
  static void mark(std::vector<uint8_t>& flags, int id) { flags[static_cast<size_t>(id)] = 1; }
  int root_of(int id) const { return graph_.info(id).root; }

  /// A root of which some node sees a part only: nobody's gradient write covers all of it.
  void note_views(const std::vector<int>& ids) {
    for (int id : ids) {
      const auto& info = graph_.info(id);
      if (info.spec.bytes() != graph_.info(info.root).spec.bytes()) mark(partial_, info.root);
    }
  }

  void visit(size_t n) {
    const Node& node = graph_.nodes()[n];
    const bool reached =
        std::any_of(node.outputs.begin(), node.outputs.end(), [&](int id) { return at(has_, root_of(id)); });
    if (!reached) return;
    BackwardStep step{.node = n,
                      .wants = std::vector<uint8_t>(node.inputs.size()),
                      .accumulate = std::vector<uint8_t>(node.inputs.size()),
                      .zero_roots = {}};
    bool any = false;
    for (size_t i = 0; i < node.inputs.size(); ++i) any = want(node, i, step) || any;
    if (!any) return;
    for (int id : node.outputs) zero_unless_there(root_of(id), step);
    plan_.steps.push_back(std::move(step));
  }

  bool want(const Node& node, size_t i, BackwardStep& step) {
    const int root = root_of(node.inputs[i]);
    if (!node.op->differentiable(i) || !at(requires_, root)) return false;
    for (size_t j = 0; j < i; ++j)
      if (step.wants[j] != 0 && overlap(node.inputs[i], node.inputs[j]))
        throw Error(fmt::format("[{}] reads the same tensor twice and wants its gradient", node.op->name()));
    step.wants[i] = 1;
    if (at(partial_, root)) zero_unless_there(root, step);
    step.accumulate[i] = has_[static_cast<size_t>(root)];
    mark(has_, root);
    return true;
  }

  void zero_unless_there(int root, BackwardStep& step) {
    if (at(has_, root)) return;
    step.zero_roots.push_back(root);
    mark(has_, root);
  }

  bool overlap(int a, int b) const {
    const auto& x = graph_.info(a);
    const auto& y = graph_.info(b);
    return x.root == y.root && x.offset < y.offset + y.spec.bytes() && y.offset < x.offset + x.spec.bytes();
  }

  Graph& graph_;
  std::vector<uint8_t> requires_;  ///< by root: depends on a trained parameter
  std::vector<uint8_t> has_;       ///< by root: its gradient holds something
  std::vector<uint8_t> partial_;   ///< by root
  BackwardPlan plan_;
};

}  // namespace

double backward_flop(const Node& node, const BackwardStep& step, double full) {
  const bool product = node.inputs.size() >= 2 && node.op->differentiable(0) && node.op->differentiable(1);
  return product && (step.wants[0] == 0) != (step.wants[1] == 0) ? full / 2 : full;
}

BackwardPlan plan_backward(Graph& graph, Value loss, const std::vector<std::string>& trained) {
  for (const auto& name : trained) graph.gradient(name);
  return Walk(graph, trained).run(loss);
}

}  // namespace vkopple
