#include "graph/graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/error.h"

namespace vkopple {

const TensorSpec& Value::spec() const { return graph_->info(id_).spec; }

Scope::Scope(Graph& graph, const std::string& name) : graph_(&graph) {
  before_ = graph.set_scope(graph.scope().empty() ? name : graph.scope() + "/" + name);
}

int Graph::add_value(ValueInfo info) {
  const int id = static_cast<int>(values_.size());
  if (info.root < 0) info.root = id;
  values_.push_back(std::move(info));
  return id;
}

Value Graph::input(const std::string& name, const TensorSpec& spec) {
  if (inputs_.contains(name)) throw Error(fmt::format("the graph has an input {} already", name));
  const int id = add_value({.spec = spec, .role = Role::kInput, .name = name, .kept = true});
  inputs_[name] = id;
  return {*this, id};
}

Value Graph::add_member(std::map<std::string, std::vector<GroupMember>>& groups, Role role,
                        const std::string& group, const std::string& name, const TensorSpec& spec) {
  if (members_.contains(name)) throw Error(fmt::format("the graph has a tensor {} already", name));
  const auto [entry, added] = roots_.try_emplace(group, -1);
  if (added) entry->second = add_value({.spec = row_major({1}), .role = role, .name = group, .kept = true});
  const int root = entry->second;
  if (info(root).role != role) throw Error(fmt::format("group {} holds parameters and state both", group));
  // The flat tensor ends with its last member, padded so that every member can be bound by itself.
  auto& members = groups[group];
  uint64_t offset = 0;
  if (!members.empty()) {
    const auto& last = info(members.back().value);
    offset = aligned(last.offset + last.spec.bytes());
  }
  const int id =
      add_value({.spec = spec, .root = root, .offset = offset, .role = role, .name = name, .kept = true});
  const auto words = static_cast<int64_t>(aligned(offset + spec.bytes()) / 4);
  values_[static_cast<size_t>(root)].spec = row_major({words});
  if (const auto g = gradients_.find(root); g != gradients_.end())
    values_[static_cast<size_t>(g->second)].spec = row_major({words});
  members.push_back({name, id});
  members_[name] = id;
  return {*this, id};
}

Value Graph::parameter(const std::string& group, const std::string& name, const Shape& shape) {
  return add_member(parameters_, Role::kParameter, group, name, row_major(shape));
}

Value Graph::state(const std::string& group, const std::string& name, const TensorSpec& spec) {
  return add_member(states_, Role::kState, group, name, spec);
}

Value Graph::group(const std::string& group) {
  const auto found = roots_.find(group);
  if (found == roots_.end()) throw Error(fmt::format("the graph has no group {}", group));
  return {*this, found->second};
}

Value Graph::gradient(const std::string& name) {
  const int root = group(name).id();
  if (info(root).role != Role::kParameter) throw Error(fmt::format("group {} has no gradient", name));
  const auto [entry, added] = gradients_.try_emplace(root, -1);
  if (added)
    entry->second =
        add_value({.spec = info(root).spec, .role = Role::kGradient, .name = name + "/gradient", .kept = true});
  return {*this, entry->second};
}

int Graph::gradient_of(int root) const {
  const auto found = gradients_.find(root);
  return found == gradients_.end() ? -1 : found->second;
}

std::vector<Value> Graph::apply(std::shared_ptr<const Op> op, const std::vector<Value>& inputs) {
  std::vector<TensorSpec> specs;
  Node node{.op = std::move(op), .inputs = {}, .outputs = {}, .scope = scope_};
  for (const Value& value : inputs) {
    specs.push_back(value.spec());
    node.inputs.push_back(value.id());
  }
  std::vector<Value> outputs;
  for (const TensorSpec& spec : infer_stored(*node.op, specs, activations_)) {
    node.outputs.push_back(add_value({.spec = spec}));
    outputs.emplace_back(*this, node.outputs.back());
  }
  nodes_.push_back(std::move(node));
  return outputs;
}

void Graph::update(std::shared_ptr<const Op> op, const std::vector<Value>& inputs) {
  Node node{.op = std::move(op), .inputs = {}, .outputs = {}, .scope = scope_};
  std::vector<TensorSpec> specs;
  for (const Value& value : inputs) {
    specs.push_back(value.spec());
    node.inputs.push_back(value.id());
  }
  if (!node.op->infer(specs).empty())
    throw Error(fmt::format("[{}] an update has no outputs", node.op->name()));
  updates_.push_back(std::move(node));
}

Value Graph::view(Value value, const TensorSpec& spec, uint64_t offset) {
  const ValueInfo base = info(value.id());
  ValueInfo made{.spec = spec, .root = base.root, .offset = base.offset + offset, .role = base.role};
  made.kept = base.kept;
  return {*this, add_value(std::move(made))};
}

Value Graph::reshape(Value value, const TensorSpec& wanted) {
  const TensorSpec spec = stored_as(wanted, value.spec().storage);
  if (spec.bytes() != value.spec().bytes() || spec.dtype != value.spec().dtype)
    throw Error(fmt::format("can't reshape {} to {}", value.shape().text(), spec.shape.text()));
  return view(value, spec, 0);
}

Value Graph::slice_outer(Value value, int64_t begin, int64_t count) {
  const Shape& shape = value.shape();
  if (begin < 0 || count < 1 || begin + count > shape[0])
    throw Error(fmt::format("entries {} to {} of {} do not exist", begin, begin + count, shape.text()));
  TensorSpec spec = value.spec();
  if (!can_slice_outer(value, begin))
    throw Error(
        fmt::format("entry {} of {} does not start at an aligned byte; use a slice op", begin, shape.text()));
  const uint64_t step = spec.bytes() / static_cast<uint64_t>(shape[0]);
  spec.shape = shape.with(0, count);
  return view(value, spec, step * static_cast<uint64_t>(begin));
}

bool Graph::can_slice_outer(Value value, int64_t begin) const {
  const uint64_t step = value.spec().bytes() / static_cast<uint64_t>(value.shape()[0]);
  const uint64_t offset = info(value.id()).offset + step * static_cast<uint64_t>(begin);
  return aligned(offset) == offset;
}

void Graph::keep(const std::string& name, Value value) {
  if (!kept_.try_emplace(name, value.id()).second)
    throw Error(fmt::format("the graph keeps a value {} already", name));
  values_[static_cast<size_t>(info(value.id()).root)].kept = true;
}

Value Graph::find(const std::string& name) {
  if (const auto m = members_.find(name); m != members_.end()) return {*this, m->second};
  if (const auto i = inputs_.find(name); i != inputs_.end()) return {*this, i->second};
  if (const auto k = kept_.find(name); k != kept_.end()) return {*this, k->second};
  throw Error(fmt::format("the graph has no tensor {}", name));
}

}  // namespace vkopple
