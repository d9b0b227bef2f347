#include "graph/ops/concat.h"
#include "graph/ops/crop.h"
#include "graph/ops/permute.h"
#include "graph/ops/slice.h"
#include "train/exchange/onnx/onnx_translators.h"

namespace vkopple {

void relayout_to_onnx(OnnxGraph& onnx, const Node& node) {
  onnx.define(node.outputs[0], onnx.tensor(node.inputs[0]));
}

void concat_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto axis = static_cast<std::int64_t>(op_of<Concat>(node).axis());
  onnx.define(node.outputs[0], onnx.add("Concat", inputs_of(onnx, node), {{"axis", axis}}));
}

void slice_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& op = op_of<SliceOp>(node);
  onnx.define(node.outputs[0], onnx.slice(onnx.tensor(node.inputs[0]), static_cast<std::int64_t>(op.axis()),
                                          op.begin(), op.count()));
}

void crop_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& op = op_of<Crop>(node);
  const Shape& window = onnx.shape(node.outputs[0]);
  const std::string rows = onnx.slice(onnx.tensor(node.inputs[0]), 2, op.top(), window[2]);
  onnx.define(node.outputs[0], onnx.slice(rows, 3, op.left(), window[3]));
}

void permute_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& order = op_of<Permute>(node).order();
  const std::vector<std::int64_t> perm(order.begin(), order.end());
  onnx.define(node.outputs[0], onnx.add("Transpose", inputs_of(onnx, node), {{"perm", perm}}));
}

}  // namespace vkopple
