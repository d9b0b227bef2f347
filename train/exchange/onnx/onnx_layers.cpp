#include <array>
#include <span>

#include "graph/ops/batch_norm.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/conv_transpose2d.h"
#include "graph/ops/lstm.h"
#include "train/exchange/onnx/onnx_translators.h"

namespace vkopple {
namespace {

using Ints = std::vector<std::int64_t>;

/// Gates i f g o, one after the other along the first axis, in ONNX's order i o f g.
std::vector<float> with_onnx_gates(const StoredTensor& tensor) {
  constexpr std::array<std::size_t, 4> kOrder{0, 3, 1, 2};
  const std::vector<float> values = to_floats(tensor);
  const std::size_t gate = values.size() / kOrder.size();
  std::vector<float> ordered;
  for (const std::size_t from : kOrder) {
    const auto part = std::span(values).subspan(from * gate, gate);
    ordered.insert(ordered.end(), part.begin(), part.end());
  }
  return ordered;
}

}  // namespace

void conv2d_to_onnx(OnnxGraph& onnx, const Node& node) {
  const Conv2dOptions& o = op_of<Conv2d>(node).options();
  const Shape& w = onnx.shape(node.inputs[1]);
  onnx.define(node.outputs[0], onnx.add("Conv", inputs_of(onnx, node),
                                        {{"kernel_shape", Ints{w[2], w[3]}},
                                         {"strides", Ints(2, o.stride)},
                                         {"pads", Ints(4, o.padding)},
                                         {"dilations", Ints(2, o.dilation)}}));
}

void conv_transpose2d_to_onnx(OnnxGraph& onnx, const Node& node) {
  const ConvShape shape =
      ConvTranspose2d::convolution_of(onnx.shape(node.inputs[0]), onnx.shape(node.inputs[1]));
  // The convolution's rounding down says how many rows the transposed one adds at the end.
  const std::int64_t smallest = (shape.ho - 1) * shape.stride + shape.kernel - 2 * shape.padding;
  onnx.define(node.outputs[0], onnx.add("ConvTranspose", inputs_of(onnx, node),
                                        {{"kernel_shape", Ints(2, shape.kernel)},
                                         {"strides", Ints(2, shape.stride)},
                                         {"pads", Ints(4, shape.padding)},
                                         {"output_padding", Ints(2, shape.h - smallest)}}));
}

void linear_to_onnx(OnnxGraph& onnx, const Node& node) {
  const std::string transposed = onnx.add("Transpose", {onnx.tensor(node.inputs[1])}, {{"perm", Ints{1, 0}}});
  std::string y = onnx.add("MatMul", {onnx.tensor(node.inputs[0]), transposed});
  if (node.inputs.size() > 2) y = onnx.add("Add", {y, onnx.tensor(node.inputs[2])});
  onnx.define(node.outputs[0], y);
}

/// ONNX: X (steps, B, I), W (1, 4H, I), R (1, 4H, H), B (1, 8H) → Y (steps, 1, B, H).
void lstm_to_onnx(OnnxGraph& onnx, const Node& node) {
  const Shape& x = onnx.shape(node.inputs[0]);
  const Shape& y = onnx.shape(node.outputs[0]);
  const std::int64_t hidden = y[2];
  const std::int64_t steps = op_of<Lstm>(node).steps();
  const auto gates = [&](std::size_t input) { return with_onnx_gates(onnx.weight(node.inputs[input])); };
  std::vector<float> biases = gates(3);
  const std::vector<float> hidden_biases = gates(4);
  biases.insert(biases.end(), hidden_biases.begin(), hidden_biases.end());
  const std::string once = onnx.reshape(onnx.tensor(node.inputs[0]), {1, x[0], x[1]});
  const std::string repeated = onnx.add("Expand", {once, onnx.ints(Ints{steps, x[0], x[1]})});
  const std::string all =
      onnx.add("LSTM",
               {repeated, onnx.floats({1, 4 * hidden, x[1]}, gates(1)),
                onnx.floats({1, 4 * hidden, hidden}, gates(2)), onnx.floats({1, 8 * hidden}, biases)},
               {{"hidden_size", hidden}});
  const std::string flat = onnx.reshape(all, {steps, x[0], hidden});
  onnx.define(node.outputs[0], onnx.add("Transpose", {flat}, {{"perm", Ints{1, 0, 2}}}));
}

/// By running averages, whatever the runs of samples are.
void batch_norm_to_onnx(OnnxGraph& onnx, const Node& node) {
  const BatchNormOptions& o = op_of<BatchNorm>(node).options();
  std::vector<std::string> inputs = inputs_of(onnx, node);
  inputs.resize(5);
  if (o.slope != 1) inputs[0] = onnx.add("LeakyRelu", {inputs[0]}, {{"alpha", o.slope}});
  onnx.define(node.outputs[0], onnx.add("BatchNormalization", inputs, {{"epsilon", o.eps}}));
}

}  // namespace vkopple
