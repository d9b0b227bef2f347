#include "graph/memory_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "runtime/caps.h"

namespace vkopple {
namespace {

constexpr uint64_t kBlockBytes = uint64_t{1} << 30;

class Layouter {
 public:
  Layouter(const Graph& graph, Value loss, const BackwardPlan& backward, const Recomputation& recomputation,
           std::span<const Needs> needs)
      : graph_(graph),
        loss_(loss),
        backward_(backward),
        recomputation_(recomputation),
        needs_(needs),
        data_life_(graph.value_count()),
        again_life_(graph.value_count()),
        gradient_life_(graph.value_count()) {
    layout_.nodes.resize(graph.nodes().size());
  }

  MemoryLayout run(const Caps& caps, bool in_place) {
    follow_forward();
    follow_backward();
    want_roots();
    if (in_place) share_in_place();
    place(caps);
    return std::move(layout_);
  }

 private:
  using Stretch = MemoryLayout::Stretch;
  struct Life {
    int64_t first = -1;
    int64_t last = -1;
    void touch(int64_t time) {
      first = first < 0 ? time : std::min(first, time);
      last = std::max(last, time);
    }
  };

  size_t root(int id) const { return static_cast<size_t>(graph_.info(id).root); }
  int64_t backward_time(size_t step) const { return again_time(step) + 1; }
  int64_t again_time(size_t step) const { return static_cast<int64_t>(graph_.nodes().size() + 2 * step); }
  std::string name_of(const Node& node, const std::string& part) const {
    return fmt::format("{} {}, {}", node.scope, node.op->name(), part);
  }

  void follow_forward() {
    for (size_t n = 0; n < graph_.nodes().size(); ++n) {
      const Node& node = graph_.nodes()[n];
      const auto time = static_cast<int64_t>(n);
      for (int id : node.inputs) data_life_[root(id)].touch(time);
      for (int id : node.outputs) data_life_[root(id)].touch(time);
      layout_.nodes[n].forward_scratch =
          want(name_of(node, "scratch"), needs_[n].forward_scratch, {time, time});
    }
  }

  void follow_backward() {
    const auto& steps = backward_.steps;
    for (size_t s = 0; s < steps.size(); ++s) {
      const auto& step = steps[s];
      const Node& node = graph_.nodes()[step.node];
      const Needs& needs = needs_[step.node];
      const int64_t time = backward_time(s);
      for (size_t n : recomputation_.before[s]) {
        for (int id : graph_.nodes()[n].inputs) touch_in_backward(id, again_time(s));
        for (int id : graph_.nodes()[n].outputs) touch_in_backward(id, again_time(s));
      }
      for (size_t i = 0; i < node.inputs.size(); ++i) {
        if (in_mask(needs.inputs_for_backward, i)) touch_in_backward(node.inputs[i], time);
        if (step.wants[i] != 0) gradient_life_[root(node.inputs[i])].touch(time);
      }
      for (size_t i = 0; i < node.outputs.size(); ++i) {
        if (in_mask(needs.outputs_for_backward, i)) touch_in_backward(node.outputs[i], time);
        gradient_life_[root(node.outputs[i])].touch(time);
      }
      MemoryLayout::NodeStretches& stretches = layout_.nodes[step.node];
      stretches.backward_scratch =
          want(name_of(node, "backward scratch"), needs.backward_scratch, {time, time});
      for (const TensorSpec& spec : needs.saved)
        stretches.saved.push_back(
            want(name_of(node, "saved"), spec.bytes(), {static_cast<int64_t>(step.node), time}));
    }
    // It is set before everything.
    if (loss_) gradient_life_[root(loss_.id())].touch(again_time(0));
  }

  void touch_in_backward(int id, int64_t time) {
    (recomputation_.again(graph_.info(id).root) ? again_life_ : data_life_)[root(id)].touch(time);
  }

  Stretch want(std::string what, uint64_t bytes, Life life) {
    if (bytes == 0) return MemoryLayout::kNone;
    layout_.stretches.push_back({std::move(what), bytes, life.first, life.last});
    return static_cast<Stretch>(layout_.stretches.size()) - 1;
  }

  void want_roots() {
    std::vector<std::string> names(graph_.value_count());
    for (const Node& node : graph_.nodes())
      for (size_t i = 0; i < node.outputs.size(); ++i)
        names[root(node.outputs[i])] = name_of(node, fmt::format("output {}", i));
    const auto want_all = [&](const std::vector<Life>& lives, const char* kind, const auto& has_memory) {
      std::vector<Stretch> stretches(graph_.value_count(), MemoryLayout::kNone);
      for (size_t id = 0; id < graph_.value_count(); ++id)
        if (lives[id].first >= 0 && !has_memory(static_cast<int>(id)))
          stretches[id] = want(names[id] + kind, graph_.info(static_cast<int>(id)).spec.bytes(), lives[id]);
      return stretches;
    };
    const auto own = [&](int id) { return has_own_memory(graph_.info(id)); };
    const auto trained = [&](int id) {
      return std::count(backward_.zero_first.begin(), backward_.zero_first.end(), id) > 0;
    };
    layout_.data = want_all(data_life_, "", own);
    layout_.again = want_all(again_life_, ", again", [](int) { return false; });
    layout_.gradients = want_all(gradient_life_, ", gradient", trained);
  }

  /// Lets outputs and gradients take over the bytes of what ends with the very op that makes them. In order of
  /// time, so that a chain of such ops shares one stretch.
  void share_in_place() {
    for (size_t n = 0; n < graph_.nodes().size(); ++n) take_over(n, layout_.data, static_cast<int64_t>(n));
    const auto& steps = backward_.steps;
    for (size_t s = 0; s < steps.size(); ++s) {
      for (size_t n : recomputation_.before[s]) take_over(n, layout_.again, again_time(s));
      take_over_gradient(steps[s], backward_time(s));
    }
  }

  void take_over(size_t n, std::vector<Stretch>& stretches, int64_t time) {
    const Node& node = graph_.nodes()[n];
    const int input = node.op->in_place();
    if (input < 0) return;
    const int from = node.inputs[static_cast<size_t>(input)];
    const auto reads = [&](int id) { return root(id) == root(from); };
    if (std::count_if(node.inputs.begin(), node.inputs.end(), reads) == 1)
      merge(from, node.outputs[0], stretches, time);
  }

  void take_over_gradient(const BackwardStep& step, int64_t time) {
    const Node& node = graph_.nodes()[step.node];
    const int input = node.op->gradient_in_place();
    if (input < 0 || step.wants[static_cast<size_t>(input)] == 0 ||
        step.accumulate[static_cast<size_t>(input)] != 0)
      return;
    merge(node.outputs[0], node.inputs[static_cast<size_t>(input)], layout_.gradients, time);
  }

  /// Where `to` begins as `from` ends, and they are alike and not parts of others.
  void merge(int from, int to, std::vector<Stretch>& stretches, int64_t time) {
    const Stretch a = stretches[root(from)];
    const Stretch b = stretches[root(to)];
    const TensorSpec& spec = graph_.info(from).spec;
    const auto whole = [&](int id) {
      return graph_.info(id).spec.bytes() == graph_.info(graph_.info(id).root).spec.bytes();
    };
    if (a < 0 || b < 0 || a == b || !(spec == graph_.info(to).spec) || !whole(from) || !whole(to)) return;
    MemoryUse& earlier = layout_.stretches[static_cast<size_t>(a)];
    MemoryUse& later = layout_.stretches[static_cast<size_t>(b)];
    if (earlier.last != time || later.first != time) return;
    earlier.last = later.last;
    later.bytes = 0;  // left out below
    stretches[root(to)] = a;
  }

  void place(const Caps& caps) {
    drop_merged();
    std::vector<MemoryRequest> requests;
    for (const MemoryUse& use : layout_.stretches) requests.push_back({use.bytes, use.first, use.last});
    layout_.plan =
        plan_memory(requests, std::min(kBlockBytes, caps.max_allocation_bytes), caps.offset_alignment);
  }

  /// Of the stretches that went up in others.
  void drop_merged() {
    std::vector<Stretch> number(layout_.stretches.size(), MemoryLayout::kNone);
    Stretch left = 0;
    for (size_t i = 0; i < number.size(); ++i)
      if (layout_.stretches[i].bytes > 0) number[i] = left++;
    std::erase_if(layout_.stretches, [](const MemoryUse& use) { return use.bytes == 0; });
    const auto renumber = [&](Stretch& stretch) {
      if (stretch >= 0) stretch = number[static_cast<size_t>(stretch)];
    };
    for (auto* stretches : {&layout_.data, &layout_.again, &layout_.gradients})
      std::for_each(stretches->begin(), stretches->end(), renumber);
    for (MemoryLayout::NodeStretches& node : layout_.nodes) {
      renumber(node.forward_scratch);
      renumber(node.backward_scratch);
      std::for_each(node.saved.begin(), node.saved.end(), renumber);
    }
  }

  const Graph& graph_;
  Value loss_;
  const BackwardPlan& backward_;
  const Recomputation& recomputation_;
  std::span<const Needs> needs_;
  std::vector<Life> data_life_;   ///< by root, as all of these
  std::vector<Life> again_life_;  ///< of recomputed values, in backward
  std::vector<Life> gradient_life_;
  MemoryLayout layout_;
};

}  // namespace

bool has_own_memory(const ValueInfo& root) { return root.role != Role::kIntermediate || root.kept; }

bool in_group(const ValueInfo& root) { return root.role != Role::kIntermediate && root.role != Role::kInput; }

MemoryLayout lay_out(const Graph& graph, Value loss, const BackwardPlan& backward,
                     const Recomputation& recomputation, std::span<const Needs> needs, const Caps& caps,
                     bool in_place) {
  return Layouter(graph, loss, backward, recomputation, needs).run(caps, in_place);
}

}  // namespace vkopple
