#include "graph/executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>

#include "graph/plan.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/transfer.h"

namespace vkopple {
namespace {

constexpr uint64_t kBlockBytes = uint64_t{1} << 30;

Slice stored(Slice slice, const TensorSpec& spec) {
  slice.storage = spec.storage;
  return slice;
}

/// Has the watcher told of what a node gave when that is there.
template <class Watcher>
void watch(Recorder& recorder, const Watcher& watcher, const Node& node, size_t number,
           const std::vector<Operand>& given) {
  if (watcher) recorder.host_step([watcher, &node, number, given] { watcher(node, number, given); });
}

}  // namespace

/// Decides where every tensor lies: kept ones in an arena or a group, the rest by lifetime in shared blocks.
/// Time counts forward nodes first, then backward steps, each of which may have nodes run again before it.
class Executor::Layouter {
 public:
  Layouter(Executor& executor, bool in_place) : e_(executor), graph_(*executor.graph_), in_place_(in_place) {
    e_.data_.resize(graph_.value_count());
    e_.gradients_.resize(graph_.value_count());
    e_.node_memory_.resize(graph_.nodes().size());
    data_life_.resize(graph_.value_count());
    again_life_.resize(graph_.value_count());
    gradient_life_.resize(graph_.value_count());
    e_.again_.resize(graph_.value_count());
  }

  void run() {
    place_kept();
    follow_forward();
    follow_backward();
    want_roots();
    if (in_place_) share_in_place();
    place_shared();
  }

 private:
  struct Life {
    int64_t first = -1;
    int64_t last = -1;
    void touch(int64_t time) {
      first = first < 0 ? time : std::min(first, time);
      last = std::max(last, time);
    }
  };
  struct Pending {
    MemoryUse use;
    std::vector<Slice*> slices;  ///< several where one takes over the bytes of another
  };
  using Requests = std::vector<int64_t>;  ///< by root: index into pending_, or -1

  size_t root(int id) const { return static_cast<size_t>(graph_.info(id).root); }
  int64_t backward_time(size_t step) const { return again_time(step) + 1; }
  int64_t again_time(size_t step) const { return static_cast<int64_t>(graph_.nodes().size() + 2 * step); }
  std::string name_of(const Node& node, const std::string& part) const {
    return fmt::format("{} {}, {}", node.scope, node.op->name(), part);
  }

  void place_kept() {
    for (size_t id = 0; id < graph_.value_count(); ++id) {
      const auto& info = graph_.info(static_cast<int>(id));
      if (info.root != static_cast<int>(id)) continue;
      switch (info.role) {
        case Role::kParameter:
        case Role::kState:
        case Role::kGradient:
          e_.data_[id] = e_.groups_->get(info.name, info.spec.bytes());
          break;
        case Role::kInput:
          e_.data_[id] = e_.kept_->allocate(info.spec.bytes());
          break;
        case Role::kIntermediate:
          if (info.kept) e_.data_[id] = e_.kept_->allocate(info.spec.bytes());
          break;
      }
    }
    for (int id : e_.backward_plan_.zero_first)
      e_.gradients_[static_cast<size_t>(id)] = e_.data_[static_cast<size_t>(graph_.gradient_of(id))];
  }

  void follow_forward() {
    for (size_t n = 0; n < graph_.nodes().size(); ++n) {
      const Node& node = graph_.nodes()[n];
      const auto time = static_cast<int64_t>(n);
      for (int id : node.inputs) data_life_[root(id)].touch(time);
      for (int id : node.outputs) data_life_[root(id)].touch(time);
      want(name_of(node, "scratch"), e_.needs_[n].forward_scratch, {time, time},
           e_.node_memory_[n].forward_scratch);
    }
  }

  void follow_backward() {
    const auto& steps = e_.backward_plan_.steps;
    for (size_t s = 0; s < steps.size(); ++s) {
      const auto& step = steps[s];
      const Node& node = graph_.nodes()[step.node];
      const Needs& needs = e_.needs_[step.node];
      const int64_t time = backward_time(s);
      for (size_t n : e_.recomputation_.before[s]) {
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
      want(name_of(node, "backward scratch"), needs.backward_scratch, {time, time},
           e_.node_memory_[step.node].backward_scratch);
      auto& saved = e_.node_memory_[step.node].saved;
      for (const TensorSpec& spec : needs.saved) saved.push_back({spec, {}});
      for (auto& operand : saved)
        want(name_of(node, "saved"), operand.spec.bytes(), {static_cast<int64_t>(step.node), time},
             operand.slice);
    }
    // It is set before everything.
    if (e_.loss_) gradient_life_[root(e_.loss_.id())].touch(again_time(0));
  }

  void touch_in_backward(int id, int64_t time) {
    (e_.recomputation_.again(graph_.info(id).root) ? again_life_ : data_life_)[root(id)].touch(time);
  }

  int64_t want(std::string what, uint64_t bytes, Life life, Slice& slice) {
    if (bytes == 0) return -1;
    pending_.push_back({{std::move(what), bytes, life.first, life.last}, {&slice}});
    return static_cast<int64_t>(pending_.size()) - 1;
  }

  void want_roots() {
    std::vector<std::string> names(graph_.value_count());
    for (const Node& node : graph_.nodes())
      for (size_t i = 0; i < node.outputs.size(); ++i)
        names[root(node.outputs[i])] = name_of(node, fmt::format("output {}", i));
    const auto want_all = [&](const std::vector<Life>& lives, const char* kind, std::vector<Slice>& slices) {
      Requests requests(graph_.value_count(), -1);
      for (size_t id = 0; id < graph_.value_count(); ++id)
        if (lives[id].first >= 0 && !slices[id])
          requests[id] =
              want(names[id] + kind, graph_.info(static_cast<int>(id)).spec.bytes(), lives[id], slices[id]);
      return requests;
    };
    data_ = want_all(data_life_, "", e_.data_);
    again_ = want_all(again_life_, ", again", e_.again_);
    gradient_ = want_all(gradient_life_, ", gradient", e_.gradients_);
  }

  /// Lets outputs and gradients take over the bytes of what ends with the very op that makes them. In order of
  /// time, so that a chain of such ops shares one stretch.
  void share_in_place() {
    for (size_t n = 0; n < graph_.nodes().size(); ++n) take_over(n, data_, static_cast<int64_t>(n));
    const auto& steps = e_.backward_plan_.steps;
    for (size_t s = 0; s < steps.size(); ++s) {
      for (size_t n : e_.recomputation_.before[s]) take_over(n, again_, again_time(s));
      take_over_gradient(steps[s], backward_time(s));
    }
  }

  void take_over(size_t n, Requests& requests, int64_t time) {
    const Node& node = graph_.nodes()[n];
    const int input = node.op->in_place();
    if (input < 0) return;
    const int from = node.inputs[static_cast<size_t>(input)];
    const auto reads = [&](int id) { return root(id) == root(from); };
    if (std::count_if(node.inputs.begin(), node.inputs.end(), reads) == 1)
      merge(from, node.outputs[0], requests, time);
  }

  void take_over_gradient(const BackwardStep& step, int64_t time) {
    const Node& node = graph_.nodes()[step.node];
    const int input = node.op->gradient_in_place();
    if (input < 0 || step.wants[static_cast<size_t>(input)] == 0 ||
        step.accumulate[static_cast<size_t>(input)] != 0)
      return;
    merge(node.outputs[0], node.inputs[static_cast<size_t>(input)], gradient_, time);
  }

  /// Where `to` begins as `from` ends, and they are alike and not parts of others.
  void merge(int from, int to, Requests& requests, int64_t time) {
    const int64_t a = requests[root(from)];
    const int64_t b = requests[root(to)];
    const TensorSpec& spec = graph_.info(from).spec;
    const auto whole = [&](int id) {
      return graph_.info(id).spec.bytes() == graph_.info(graph_.info(id).root).spec.bytes();
    };
    if (a < 0 || b < 0 || a == b || !(spec == graph_.info(to).spec) || !whole(from) || !whole(to)) return;
    Pending& earlier = pending_[static_cast<size_t>(a)];
    Pending& later = pending_[static_cast<size_t>(b)];
    if (earlier.use.last != time || later.use.first != time) return;
    earlier.use.last = later.use.last;
    earlier.slices.insert(earlier.slices.end(), later.slices.begin(), later.slices.end());
    later.slices.clear();
    requests[root(to)] = a;
  }

  void place_shared() {
    std::erase_if(pending_, [](const Pending& p) { return p.slices.empty(); });
    std::vector<MemoryRequest> requests;
    for (const Pending& p : pending_) requests.push_back({p.use.bytes, p.use.first, p.use.last});
    const Caps& caps = e_.device_->caps();
    const MemoryPlan plan =
        plan_memory(requests, std::min(kBlockBytes, caps.max_allocation_bytes), caps.offset_alignment);
    if (plan.total_bytes() > caps.memory_bytes)
      throw Error(
          fmt::format("activations and gradients need {} MiB, {} has {}; use a smaller --batch or image size",
                      plan.total_bytes() >> 20, caps.name, caps.memory_bytes >> 20));
    for (uint64_t bytes : plan.block_bytes)
      e_.blocks_.push_back(std::make_unique<Buffer>(*e_.device_, bytes, MemoryKind::kDevice, "activations"));
    for (size_t i = 0; i < pending_.size(); ++i) {
      const Placement& placement = plan.placements[i];
      for (Slice* slice : pending_[i].slices)
        *slice = {e_.blocks_[placement.block].get(), placement.offset, pending_[i].use.bytes};
      e_.memory_uses_.push_back(std::move(pending_[i].use));
    }
    for (NodeMemory& memory : e_.node_memory_)
      for (Operand& saved : memory.saved) saved.slice = stored(saved.slice, saved.spec);
    e_.shared_bytes_ = plan.total_bytes();
  }

  Executor& e_;
  const Graph& graph_;
  bool in_place_;
  std::vector<Life> data_life_;   ///< by root, as all of these
  std::vector<Life> again_life_;  ///< of recomputed values, in backward
  std::vector<Life> gradient_life_;
  Requests data_;
  Requests again_;
  Requests gradient_;
  std::vector<Pending> pending_;
};

Executor::Executor(const Device& device, Graph& graph, ExecutorOptions options)
    : device_(&device),
      graph_(&graph),
      loss_(options.loss),
      loss_scale_(options.loss_scale),
      gradient_done_(std::move(options.gradient_done)),
      groups_(std::move(options.groups)) {
  if (!groups_) groups_ = std::make_shared<GroupStore>(device);
  kept_ = std::make_unique<Arena>(device, MemoryKind::kDevice, "inputs and outputs", uint64_t{4} << 20);
  if (loss_) backward_plan_ = plan_backward(graph, loss_, options.trained);
  for (const Node& node : graph.nodes()) {
    std::vector<TensorSpec> specs;
    for (int id : node.inputs) specs.push_back(stored_as(graph.info(id).spec, Storage::kFloat32));
    needs_.push_back(node.op->needs(specs, device.caps()));
    forward_flop_ += needs_.back().forward_flop;
  }
  for (const auto& step : backward_plan_.steps)
    backward_flop_ += vkopple::backward_flop(graph.nodes()[step.node], step, needs_[step.node].backward_flop);
  recomputation_ = plan_recomputation(graph, backward_plan_, needs_, options.recompute_from);
  Layouter(*this, options.in_place).run();
  forward_ = recorded_forward(options.profile, {});
  if (loss_) backward_ = recorded_backward(options.profile, {});
  if (!graph.updates().empty()) record_update(options.profile);
}

Executor::~Executor() = default;

Slice Executor::slice(Value value) const {
  const auto& info = graph_->info(value.id());
  return stored(data_[static_cast<size_t>(info.root)].sub(info.offset, info.spec.bytes()), info.spec);
}

Operand Executor::operand(int value) const { return {graph_->info(value).spec, slice({*graph_, value})}; }

Operand Executor::gradient_operand(int value) const {
  const auto& info = graph_->info(value);
  const Slice slice = gradients_[static_cast<size_t>(info.root)].sub(info.offset, info.spec.bytes());
  return {info.spec, stored(slice, info.spec)};
}

std::vector<Operand> Executor::operands(const std::vector<int>& values) const {
  std::vector<Operand> all;
  for (int id : values) all.push_back(operand(id));
  return all;
}

std::vector<Operand> Executor::operands_in_backward(const std::vector<int>& values) const {
  std::vector<Operand> all = operands(values);
  for (size_t i = 0; i < values.size(); ++i) {
    const auto& info = graph_->info(values[i]);
    if (recomputation_.again(info.root))
      all[i].slice =
          stored(again_[static_cast<size_t>(info.root)].sub(info.offset, info.spec.bytes()), info.spec);
  }
  return all;
}

std::unique_ptr<Commands> Executor::recorded_forward(bool profile, const Watcher& watcher) {
  Recorder recorder(*device_, profile);
  for (size_t n = 0; n < graph_->nodes().size(); ++n) {
    const Node& node = graph_->nodes()[n];
    const auto x = operands(node.inputs);
    const auto y = operands(node.outputs);
    recorder.begin_section();
    recorder.expect_work(needs_[n].forward_flop);
    std::vector<Operand> saved = node_memory_[n].saved;
    if (saved.empty())  // inference, or no gradient comes this way
      for (const TensorSpec& spec : needs_[n].saved) saved.push_back({spec, {}});
    node.op->record_forward(recorder, {x, y, saved, node_memory_[n].forward_scratch});
    recorder.end_section();
    watch(recorder, watcher, node, n, y);
  }
  return recorder.finish();
}

std::unique_ptr<Commands> Executor::recorded_backward(bool profile, const Watcher& watcher) {
  Recorder recorder(*device_, profile);
  backward_sections_.clear();
  for (int root : backward_plan_.zero_first) recorder.fill(gradients_[static_cast<size_t>(root)]);
  const Slice seed = gradient_operand(loss_.id()).slice;
  if (loss_scale_)
    recorder.copy(slice(loss_scale_).sub(0, seed.bytes), seed);
  else
    recorder.fill(seed, std::bit_cast<uint32_t>(1.0F));
  for (size_t s = 0; s < backward_plan_.steps.size(); ++s) {
    const BackwardStep& step = backward_plan_.steps[s];
    for (size_t n : recomputation_.before[s]) record_again(recorder, n);
    const Node& node = graph_->nodes()[step.node];
    for (int root : step.zero_roots) recorder.fill(gradients_[static_cast<size_t>(root)]);
    const auto x = operands_in_backward(node.inputs);
    const auto y = operands_in_backward(node.outputs);
    std::vector<Operand> dy;
    std::vector<Operand> dx;
    for (int id : node.outputs) dy.push_back(gradient_operand(id));
    for (size_t i = 0; i < node.inputs.size(); ++i)
      dx.push_back(step.wants[i] != 0 ? gradient_operand(node.inputs[i])
                                      : Operand{graph_->info(node.inputs[i]).spec, {}});
    const NodeMemory& memory = node_memory_[step.node];
    backward_sections_.push_back({false, s});
    recorder.begin_section();
    recorder.expect_work(needs_[step.node].backward_flop);
    node.op->record_backward(recorder, {x, y, memory.saved, dy, dx, step.accumulate, memory.backward_scratch});
    recorder.end_section();
    watch(recorder, watcher, node, s, dx);
    if (!gradient_done_ || watcher) continue;
    for (const std::string& group : gradients_done_after(s))
      recorder.host_step([this, group] { gradient_done_(group); });
  }
  return recorder.finish();
}

/// Groups of parameters that this step of backward is the last to add to.
std::vector<std::string> Executor::gradients_done_after(size_t step) const {
  const auto groups_of = [&](size_t s) {
    std::set<std::string> groups;
    const Node& node = graph_->nodes()[backward_plan_.steps[s].node];
    for (size_t i = 0; i < node.inputs.size(); ++i) {
      const ValueInfo& root = graph_->info(graph_->info(node.inputs[i]).root);
      if (backward_plan_.steps[s].wants[i] != 0 && root.role == Role::kParameter) groups.insert(root.name);
    }
    return groups;
  };
  std::set<std::string> done = groups_of(step);
  for (size_t later = step + 1; later < backward_plan_.steps.size() && !done.empty(); ++later)
    for (const std::string& group : groups_of(later)) done.erase(group);
  return {done.begin(), done.end()};
}

void Executor::record_again(Recorder& recorder, size_t n) {
  const Node& node = graph_->nodes()[n];
  const auto x = operands_in_backward(node.inputs);
  const auto y = operands_in_backward(node.outputs);
  backward_sections_.push_back({true, n});
  recorder.begin_section();
  node.op->record_again(recorder, {x, y, node_memory_[n].saved, {}});
  recorder.end_section();
}

void Executor::record_update(bool profile) {
  Recorder recorder(*device_, profile);
  for (const Node& node : graph_->updates()) {
    const auto x = operands(node.inputs);
    recorder.begin_section();
    node.op->record_forward(recorder, {x, {}, {}, {}});
    recorder.end_section();
  }
  update_ = recorder.finish();
}

void Executor::forward() { forward_ran_ = forward_->run(); }

void Executor::backward() {
  if (!backward_) throw Error("this executor was made without a loss");
  backward_ran_ = backward_->run();
}

void Executor::update() {
  if (!update_) throw Error("the graph has no update nodes");
  update_ran_ = update_->run();
}

void Executor::require_host_access(Value value, const char* what) const {
  const auto& root = graph_->info(graph_->info(value.id()).root);
  if (root.role == Role::kIntermediate && !root.kept)
    throw Error(fmt::format("can't {} an intermediate value that the graph does not keep", what));
}

void Executor::write(Value value, std::span<const float> values) {
  require_host_access(value, "write");
  const auto stored = to_layout(value.spec(), values);
  upload_values<float>(*device_, slice(value), stored);
}

void Executor::write_words(Value value, std::span<const uint32_t> values) {
  require_host_access(value, "write");
  if (static_cast<int64_t>(values.size()) != value.shape().elements())
    throw Error(
        fmt::format("{} words were given for a tensor of shape {}", values.size(), value.shape().text()));
  upload_values<uint32_t>(*device_, slice(value), values);
}

void Executor::write_end(Value value, const Slice& from) {
  require_host_access(value, "write");
  const Slice all = slice(value);
  if (from.bytes > all.bytes)
    throw Error(fmt::format("{} bytes were given for a tensor of {}", from.bytes, all.bytes));
  copy(*device_, from, all.sub(all.bytes - from.bytes, from.bytes));
}

std::vector<float> Executor::read(Value value) const {
  require_host_access(value, "read");
  return from_layout(value.spec(), download_values<float>(*device_, slice(value)));
}

std::vector<uint32_t> Executor::read_words(Value value) const {
  require_host_access(value, "read");
  return download_values<uint32_t>(*device_, slice(value));
}

std::vector<float> Executor::read_gradient(Value parameter) const {
  if (!gradients_[static_cast<size_t>(graph_->info(parameter.id()).root)])
    throw Error(fmt::format("{} receives no gradient", graph_->info(parameter.id()).name));
  const Operand gradient = gradient_operand(parameter.id());
  return from_layout(gradient.spec, download_values<float>(*device_, gradient.slice));
}

uint64_t Executor::total_bytes() const {
  return shared_bytes_ + kept_->allocated_bytes() + groups_->allocated_bytes();
}

size_t Executor::dispatches() const {
  return forward_->dispatches() + (backward_ ? backward_->dispatches() : 0) +
         (update_ ? update_->dispatches() : 0);
}

}  // namespace vkopple
