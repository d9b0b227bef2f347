#include <cmath>

#include "graph/kernels/camera.h"
#include "graph/ops/add_repeated.h"
#include "graph/ops/affine.h"
#include "graph/ops/back_project.h"
#include "graph/ops/binary.h"
#include "graph/ops/decode_location.h"
#include "graph/ops/leaky_relu.h"
#include "graph/ops/reduce_sum.h"
#include "graph/ops/sigmoid.h"
#include "graph/ops/softmax.h"
#include "train/exchange/onnx/onnx_translators.h"

namespace vkopple {

void leaky_relu_to_onnx(OnnxGraph& onnx, const Node& node) {
  const float slope = op_of<LeakyRelu>(node).slope();
  onnx.define(node.outputs[0], onnx.add("LeakyRelu", inputs_of(onnx, node), {{"alpha", slope}}));
}

void sigmoid_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& op = op_of<Sigmoid>(node);
  onnx.define(node.outputs[0],
              onnx.affine(onnx.add("Sigmoid", inputs_of(onnx, node)), op.scale(), op.offset()));
}

void softmax_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& op = op_of<Softmax>(node);
  const auto axis = static_cast<std::int64_t>(op.axis());
  onnx.define(node.outputs[0],
              onnx.add(op.log() ? "LogSoftmax" : "Softmax", inputs_of(onnx, node), {{"axis", axis}}));
}

void affine_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& op = op_of<Affine>(node);
  onnx.define(node.outputs[0], onnx.affine(onnx.tensor(node.inputs[0]), op.scale(), op.offset()));
}

void reduce_sum_to_onnx(OnnxGraph& onnx, const Node& node) {
  const auto& op = op_of<ReduceSum>(node);
  const std::vector<std::int64_t> axes(op.axes().begin(), op.axes().end());
  onnx.define(node.outputs[0], onnx.add("ReduceSum", {onnx.tensor(node.inputs[0]), onnx.ints(axes)},
                                        {{"keepdims", std::int64_t{0}}}));
}

void binary_to_onnx(OnnxGraph& onnx, const Node& node) {
  constexpr std::string_view kTypes[] = {"Add", "Sub", "Mul"};
  const auto kind = static_cast<std::size_t>(op_of<Binary>(node).kind());
  onnx.define(node.outputs[0], onnx.add(kTypes[kind], inputs_of(onnx, node)));
}

/// a's samples are ordered (f, k, i), b's (f, i).
void add_repeated_to_onnx(OnnxGraph& onnx, const Node& node) {
  const std::int64_t inner = op_of<AddRepeated>(node).inner();
  const Shape& a = onnx.shape(node.inputs[0]);
  const std::int64_t frames = onnx.shape(node.inputs[1])[0] / inner;
  const std::int64_t runs = a[0] / (frames * inner);
  const auto apart = [&](int input, std::int64_t times) {
    return onnx.reshape(onnx.tensor(input), {frames, times, inner, a[1], a[2], a[3]});
  };
  const std::string sum = onnx.add("Add", {apart(node.inputs[0], runs), apart(node.inputs[1], 1)});
  onnx.define(node.outputs[0], onnx.reshape(sum, stored(a)));
}

void slot_masks_to_onnx(OnnxGraph& onnx, const Node& node) {
  const Shape& masks = onnx.shape(node.outputs[0]);
  const std::string logits =
      onnx.add("Transpose", inputs_of(onnx, node), {{"perm", std::vector<std::int64_t>{1, 0, 2, 3}}});
  const std::string background = onnx.add("Expand", {onnx.scalar(0), onnx.ints(stored(masks.with(1, 1)))});
  const std::string all = onnx.add("Concat", {logits, background}, {{"axis", std::int64_t{1}}});
  onnx.define(node.outputs[0], onnx.add("Softmax", {all}, {{"axis", std::int64_t{1}}}));
}

/// docs/model.md §6: Σ π P / (Σ π + 1e-22), the sum over pixels as a product of matrices.
void mask_centroid_to_onnx(OnnxGraph& onnx, const Node& node) {
  const Shape& masks = onnx.shape(node.inputs[0]);
  const std::int64_t batch = masks[0], objects = masks[1] - 1, pixels = masks[2] * masks[3];
  const std::string weights =
      onnx.reshape(onnx.slice(onnx.tensor(node.inputs[0]), 1, 0, objects), {batch, objects, pixels});
  const std::string points =
      onnx.add("Transpose", {onnx.reshape(onnx.tensor(node.inputs[1]), {batch, 3, pixels})},
               {{"perm", std::vector<std::int64_t>{0, 2, 1}}});
  const std::string sum = onnx.add("MatMul", {weights, points});
  const std::string total = onnx.add("ReduceSum", {weights, onnx.ints(std::vector<std::int64_t>{2})},
                                     {{"keepdims", std::int64_t{1}}});
  onnx.define(node.outputs[0], onnx.add("Div", {sum, onnx.affine(total, 1, 1e-22F)}));
}

/// docs/model.md §2.2: θ = 0.6 fov (2σ(l₀) − 1), ρ = max_depth σ(l₁), (ρ sin θ, ρ cos θ, max_height (2σ(l₂) −
/// 1)).
void decode_location_to_onnx(OnnxGraph& onnx, const Node& node) {
  const LocationRange& range = op_of<DecodeLocation>(node).range();
  const std::string share = onnx.add("Sigmoid", {onnx.slice(onnx.tensor(node.inputs[0]), 2, 0, 3)});
  const auto scaled = [&](std::int64_t number, float scale, float offset) {
    return onnx.affine(onnx.slice(share, 2, number, 1), scale, offset);
  };
  const std::string angle = scaled(0, 1.2F * range.fov, -0.6F * range.fov);
  const std::string distance = scaled(1, range.max_depth, 0);
  const std::string z = scaled(2, 2 * range.max_height, -range.max_height);
  const std::string x = onnx.add("Mul", {distance, onnx.add("Sin", {angle})});
  const std::string y = onnx.add("Mul", {distance, onnx.add("Cos", {angle})});
  onnx.define(node.outputs[0], onnx.add("Concat", {x, y, z}, {{"axis", std::int64_t{2}}}));
}

/// docs/model.md §1: a pixel's depth times its unit ray, a constant here.
void back_project_to_onnx(OnnxGraph& onnx, const Node& node) {
  const Shape& points = onnx.shape(node.outputs[0]);
  const std::int64_t height = points[2], width = points[3];
  const auto pixels = static_cast<std::size_t>(height * width);
  const double focal = focal_length(height, op_of<BackProject>(node).fov());
  const auto centre_x = static_cast<double>(centre(width)), centre_y = static_cast<double>(centre(height));
  std::vector<float> rays(3 * pixels);
  for (std::int64_t row = 0; row < height; ++row)
    for (std::int64_t column = 0; column < width; ++column) {
      const double right = (static_cast<double>(column) - centre_x) / focal;
      const double up = (centre_y - static_cast<double>(row)) / focal;
      const double length = std::sqrt(1 + right * right + up * up);
      const auto at = static_cast<std::size_t>(row * width + column);
      rays[at] = static_cast<float>(right / length);
      rays[at + pixels] = static_cast<float>(1 / length);
      rays[at + 2 * pixels] = static_cast<float>(up / length);
    }
  const std::string constant = onnx.floats({1, 3, height, width}, rays);
  onnx.define(node.outputs[0], onnx.add("Mul", {onnx.tensor(node.inputs[0]), constant}));
}

}  // namespace vkopple
