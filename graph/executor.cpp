#include "graph/executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>

#include "graph/kernels/add_scaled.h"
#include "runtime/byte_text.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/memory_budget.h"
#include "runtime/transfer.h"

namespace vkopple {
namespace {

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

Executor::Executor(const Device& device, Graph& graph, ExecutorOptions options)
    : device_(&device),
      graph_(&graph),
      loss_(options.loss),
      loss_scale_(options.loss_scale),
      gradient_done_(options.gradient_done),
      portions_(options.portions),
      groups_(options.groups),
      plan_(plan_execution(device.caps(), graph, options)) {
  if (!groups_) groups_ = std::make_shared<GroupStore>(device);
  require_memory();
  kept_ = std::make_unique<Arena>(device, MemoryKind::kDevice, "inputs and outputs", kKeptBlockBytes);
  place_own();
  place_shared();
  for (const Needs& needs : plan_.needs) forward_flop_ += needs.forward_flop;
  for (const auto& step : plan_.backward.steps)
    backward_flop_ +=
        vkopple::backward_flop(graph.nodes()[step.node], step, plan_.needs[step.node].backward_flop);
  forward_ = recorded_forward(options.profile, {});
  if (loss_) backward_ = recorded_backward(options.profile, {});
  if (loss_ && portions_ > 1) {
    Recorder recorder(device);
    clear_gradients(recorder);
    clear_ = recorder.finish();
  }
  if (!graph.updates().empty()) record_update(options.profile);
}

void Executor::require_memory() const {
  uint64_t bytes = plan_.own_bytes();
  for (const auto& [name, group_bytes] : plan_.groups)
    if (!groups_->has(name)) bytes += group_bytes;
  const uint64_t free = free_memory(*device_);
  if (bytes > free)
    throw Error(fmt::format("{} of memory are needed, {} has {} free; use a smaller batch or image size",
                            byte_text(bytes), device_->caps().name, byte_text(free)));
}

/// What is in groups or kept.
void Executor::place_own() {
  data_.resize(graph_->value_count());
  gradients_.resize(graph_->value_count());
  for (size_t id = 0; id < graph_->value_count(); ++id) {
    const ValueInfo& info = graph_->info(static_cast<int>(id));
    if (info.root != static_cast<int>(id) || !has_own_memory(info)) continue;
    data_[id] =
        in_group(info) ? groups_->get(info.name, info.spec.bytes()) : kept_->allocate(info.spec.bytes());
  }
  for (int id : plan_.backward.zero_first)
    gradients_[static_cast<size_t>(id)] = data_[static_cast<size_t>(graph_->gradient_of(id))];
}

/// The rest, as the layout has it.
void Executor::place_shared() {
  const MemoryLayout& layout = plan_.layout;
  for (uint64_t bytes : layout.plan.block_bytes)
    blocks_.push_back(std::make_unique<Buffer>(*device_, bytes, MemoryKind::kDevice, "activations"));
  const auto slice_of = [&](MemoryLayout::Stretch stretch) -> Slice {
    if (stretch == MemoryLayout::kNone) return {};
    const auto index = static_cast<size_t>(stretch);
    const Placement& placement = layout.plan.placements[index];
    return {blocks_[placement.block].get(), placement.offset, layout.stretches[index].bytes};
  };
  again_.resize(graph_->value_count());
  for (size_t id = 0; id < graph_->value_count(); ++id) {
    if (layout.data[id] != MemoryLayout::kNone) data_[id] = slice_of(layout.data[id]);
    if (layout.gradients[id] != MemoryLayout::kNone) gradients_[id] = slice_of(layout.gradients[id]);
    again_[id] = slice_of(layout.again[id]);
  }
  for (size_t n = 0; n < graph_->nodes().size(); ++n) {
    const MemoryLayout::NodeStretches& stretches = layout.nodes[n];
    NodeMemory& memory = node_memory_.emplace_back();
    memory.forward_scratch = slice_of(stretches.forward_scratch);
    memory.backward_scratch = slice_of(stretches.backward_scratch);
    for (size_t i = 0; i < stretches.saved.size(); ++i) {
      const TensorSpec& spec = plan_.needs[n].saved[i];
      memory.saved.push_back({spec, stored(slice_of(stretches.saved[i]), spec)});
    }
  }
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
    if (plan_.recomputation.again(info.root))
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
    recorder.expect_work(plan_.needs[n].forward_flop);
    std::vector<Operand> saved = node_memory_[n].saved;
    if (saved.empty())  // inference, or no gradient comes this way
      for (const TensorSpec& spec : plan_.needs[n].saved) saved.push_back({spec, {}});
    node.op->record_forward(recorder, {x, y, saved, node_memory_[n].forward_scratch});
    recorder.end_section();
    watch(recorder, watcher, node, n, y);
  }
  return recorder.finish();
}

std::unique_ptr<Commands> Executor::recorded_backward(bool profile, const Watcher& watcher) {
  Recorder recorder(*device_, profile);
  backward_sections_.clear();
  if (portions_ == 1) clear_gradients(recorder);
  set_loss_gradient(recorder);
  for (size_t s = 0; s < plan_.backward.steps.size(); ++s) {
    const BackwardStep& step = plan_.backward.steps[s];
    for (size_t n : plan_.recomputation.before[s]) record_again(recorder, n);
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
    recorder.expect_work(plan_.needs[step.node].backward_flop);
    node.op->record_backward(recorder, {x, y, memory.saved, dy, dx, step.accumulate, memory.backward_scratch});
    recorder.end_section();
    watch(recorder, watcher, node, s, dx);
    if (!gradient_done_ || watcher) continue;
    for (const std::string& group : gradients_done_after(s))
      recorder.host_step([this, group] { gradient_done_(group); });
  }
  return recorder.finish();
}

void Executor::clear_gradients(Recorder& recorder) const {
  for (int root : plan_.backward.zero_first) recorder.fill(gradients_[static_cast<size_t>(root)]);
}

/// As large as a portion's share in the mean.
void Executor::set_loss_gradient(Recorder& recorder) const {
  const Operand seed = gradient_operand(loss_.id());
  const float share = 1.0F / static_cast<float>(portions_);
  if (loss_scale_)
    add_scaled(recorder, {seed.spec, slice(loss_scale_).sub(0, seed.slice.bytes)}, seed, share, false);
  else
    recorder.fill(seed.slice, std::bit_cast<uint32_t>(share));
}

/// Groups of parameters that this step of backward is the last to add to.
std::vector<std::string> Executor::gradients_done_after(size_t step) const {
  const auto groups_of = [&](size_t s) {
    std::set<std::string> groups;
    const Node& node = graph_->nodes()[plan_.backward.steps[s].node];
    for (size_t i = 0; i < node.inputs.size(); ++i) {
      const ValueInfo& root = graph_->info(graph_->info(node.inputs[i]).root);
      if (plan_.backward.steps[s].wants[i] != 0 && root.role == Role::kParameter) groups.insert(root.name);
    }
    return groups;
  };
  std::set<std::string> done = groups_of(step);
  for (size_t later = step + 1; later < plan_.backward.steps.size() && !done.empty(); ++later)
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

void Executor::backward(Portion portion) {
  if (!backward_) throw Error("this executor was made without a loss");
  if (clear_ && portion == Portion::kFirst) clear_->run();
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
  return shared_bytes() + kept_->allocated_bytes() + groups_->allocated_bytes();
}

size_t Executor::dispatches() const {
  return forward_->dispatches() + (backward_ ? backward_->dispatches() : 0) +
         (update_ ? update_->dispatches() : 0);
}

}  // namespace vkopple
