#include "train/exchange/onnx/onnx_export.h"

#include <fmt/format.h>

#include "models/perception_graph.h"
#include "onnx.pb.h"
#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/exchange/colour_order.h"
#include "train/exchange/onnx/onnx_graph.h"
#include "train/exchange/onnx/onnx_translators.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr std::int64_t kOpset = 17;
constexpr std::int64_t kIrVersion = 8;  // the one that came with opset 17

void describe(onnx::ValueInfoProto& info, const std::string& name, const Shape& shape) {
  info.set_name(name);
  auto& tensor = *info.mutable_type()->mutable_tensor_type();
  tensor.set_elem_type(onnx::TensorProto::FLOAT);
  for (const std::int64_t size : shape.sizes()) tensor.mutable_shape()->add_dim()->set_dim_value(size);
}

void translate(const Graph& graph, const std::map<std::string, StoredTensor>& weights, onnx::GraphProto& out) {
  OnnxGraph onnx(graph, weights, out);
  for (const auto& [name, value] : graph.inputs()) {
    describe(*out.add_input(), name, onnx.shape(value));
    onnx.define(value, name);
  }
  for (const Node& node : graph.nodes()) {
    const OnnxTranslator translator = find_onnx_translator(node.op->name());
    if (translator == nullptr)
      throw Error(
          fmt::format("the op {} of {} has no form in ONNX yet; export the weights as .pt or .safetensors",
                      node.op->name(), node.scope));
    onnx.set_scope(node.scope);
    translator(onnx, node);
  }
  for (const auto& [name, value] : graph.kept()) {
    describe(*out.add_output(), name, onnx.shape(value));
    onnx::NodeProto& node = *out.add_node();
    node.set_op_type("Identity");
    node.set_name("output/" + name);
    node.add_input(onnx.tensor(value));
    node.add_output(name);
  }
}

}  // namespace

void export_onnx(const std::filesystem::path& path, const ModelWeights& weights, std::int64_t batch, bool bgr) {
  if (weights.header.config.model.orientation != Orientation::kYaw)
    throw Error(
        fmt::format("{}: a model with 3D rotation (model.orientation) can't be exported as .onnx; export its "
                    "weights as .pt or .safetensors",
                    one_line(path.string(), 4096)));
  std::map<std::string, StoredTensor> tensors = weights.tensors;
  if (bgr) swap_red_and_blue(tensors);
  Graph graph;
  perception_graph(graph, weights.header.config.model, batch, true);
  onnx::ModelProto model;
  model.set_ir_version(kIrVersion);
  model.set_producer_name("vkopple");
  model.add_opset_import()->set_version(kOpset);
  std::map<std::string, std::string> metadata = checkpoint_metadata(weights.header);
  metadata["colours"] = bgr ? "bgr" : "rgb";
  for (const auto& [key, value] : metadata) {
    onnx::StringStringEntryProto& entry = *model.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  }
  onnx::GraphProto& out = *model.mutable_graph();
  out.set_name("opple");
  translate(graph, tensors, out);
  std::string bytes;
  if (!model.SerializeToString(&bytes))
    throw Error(fmt::format("{}: the model is too large for ONNX", path.string()));
  write_file(path, bytes);
}

}  // namespace vkopple
