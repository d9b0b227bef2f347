#include "train/exchange/onnx/onnx_graph.h"

#include <fmt/format.h>

#include "onnx.pb.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

void set(onnx::AttributeProto& to, std::int64_t value) {
  to.set_type(onnx::AttributeProto::INT);
  to.set_i(value);
}
void set(onnx::AttributeProto& to, float value) {
  to.set_type(onnx::AttributeProto::FLOAT);
  to.set_f(value);
}
void set(onnx::AttributeProto& to, const std::vector<std::int64_t>& values) {
  to.set_type(onnx::AttributeProto::INTS);
  to.mutable_ints()->Assign(values.begin(), values.end());
}

}  // namespace

StoredShape stored(const Shape& shape) { return {shape.sizes().begin(), shape.sizes().end()}; }

OnnxGraph::OnnxGraph(const Graph& graph, const std::map<std::string, StoredTensor>& weights,
                     onnx::GraphProto& out)
    : graph_(graph), weights_(weights), out_(out) {
  for (const auto* groups : {&graph.parameters(), &graph.states()}) {
    for (const auto& [group, members] : *groups)
      for (const GroupMember& member : members) members_[member.value] = member.name;
  }
}

const StoredTensor& OnnxGraph::weight(int value) const {
  const auto name = members_.find(value);
  if (name == members_.end()) throw Error(fmt::format("{} is no weight", shape(value).text()));
  const auto found = weights_.find(name->second);
  if (found == weights_.end()) throw Error("there are no values of the weight " + name->second);
  return found->second;
}

std::string OnnxGraph::tensor(int value) {
  if (const auto known = tensors_.find(value); known != tensors_.end()) return known->second;
  std::string name;
  if (const auto member = members_.find(value); member != members_.end()) {
    name = member->second;
    constant(name, weight(value));
  } else {
    name = view(value);
  }
  define(value, name);
  return name;
}

/// A view has the bytes of its root from an offset on, in another shape; in NC4HW4, only the outermost size may
/// be another.
std::string OnnxGraph::view(int value) {
  const ValueInfo& info = graph_.info(value);
  if (info.root == value) throw Error(fmt::format("{}: used before it is made", info.spec.shape.text()));
  const TensorSpec& root = graph_.info(info.root).spec;
  const Shape& shape = info.spec.shape;
  const std::string whole = tensor(info.root);
  if (shape == root.shape) return whole;
  if (root.layout == Layout::kChannels4) {
    if (shape.rank() != 4 || shape.with(0, root.shape[0]) != root.shape)
      throw Error(
          fmt::format("a view {} of {} in NC4HW4 has no form in ONNX", shape.text(), root.shape.text()));
    const auto sample = static_cast<std::int64_t>(root.bytes()) / root.shape[0];
    return slice(whole, 0, static_cast<std::int64_t>(info.offset) / sample, shape[0]);
  }
  if (shape.elements() == root.shape.elements()) return reshape(whole, stored(shape));
  const std::string flat = reshape(whole, {-1});
  const auto begin = static_cast<std::int64_t>(info.offset / sizeof(float));
  return reshape(slice(flat, 0, begin, shape.elements()), stored(shape));
}

std::string OnnxGraph::fresh(std::string_view kind) {
  return fmt::format("{}{}{}_{}", scope_, scope_.empty() ? "" : "/", kind, count_++);
}

std::string OnnxGraph::add(std::string_view type, const std::vector<std::string>& inputs,
                           const OnnxAttributes& attributes) {
  onnx::NodeProto& node = *out_.add_node();
  node.set_op_type(std::string(type));
  const std::string name = fresh(type);
  node.set_name(name);
  node.add_output(name);
  node.mutable_input()->Assign(inputs.begin(), inputs.end());
  for (const auto& [key, value] : attributes) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(std::string(key));
    std::visit([&](const auto& v) { set(attribute, v); }, value);
  }
  return name;
}

void OnnxGraph::constant(const std::string& name, const TensorView& values) {
  onnx::TensorProto& tensor = *out_.add_initializer();
  tensor.set_name(name);
  tensor.mutable_dims()->Assign(values.shape.begin(), values.shape.end());
  tensor.set_data_type(values.dtype == StoredType::kI64 ? onnx::TensorProto::INT64 : onnx::TensorProto::FLOAT);
  tensor.set_raw_data(values.bytes.data(), values.bytes.size());
}

std::string OnnxGraph::floats(const StoredShape& shape, std::span<const float> values) {
  const std::string name = fresh("constant");
  constant(name, TensorView(shape, values));
  return name;
}

std::string OnnxGraph::ints(std::span<const std::int64_t> values) {
  const std::string name = fresh("constant");
  const auto count = static_cast<std::int64_t>(values.size());
  constant(name, TensorView(StoredType::kI64, {count}, std::as_bytes(values)));
  return name;
}

std::string OnnxGraph::reshape(const std::string& x, const StoredShape& shape) {
  return add("Reshape", {x, ints(shape)});
}

std::string OnnxGraph::slice(const std::string& x, std::int64_t axis, std::int64_t begin, std::int64_t count) {
  const std::int64_t end = begin + count;
  return add("Slice", {x, ints(std::span(&begin, 1)), ints(std::span(&end, 1)), ints(std::span(&axis, 1))});
}

std::string OnnxGraph::affine(const std::string& x, float scale, float offset) {
  const std::string scaled = scale == 1 ? x : add("Mul", {x, scalar(scale)});
  return offset == 0 ? scaled : add("Add", {scaled, scalar(offset)});
}

}  // namespace vkopple
