#pragma once

#include <string_view>

#include "train/exchange/onnx/onnx_graph.h"

namespace vkopple {

/// Writes one node of a graph as nodes of ONNX, and defines its outputs.
using OnnxTranslator = void (*)(OnnxGraph& onnx, const Node& node);

/// Of an op by name; null where it has no form in ONNX yet.
OnnxTranslator find_onnx_translator(std::string_view op);

// onnx_layers.cpp
void conv2d_to_onnx(OnnxGraph& onnx, const Node& node);
void conv_transpose2d_to_onnx(OnnxGraph& onnx, const Node& node);
void linear_to_onnx(OnnxGraph& onnx, const Node& node);
void lstm_to_onnx(OnnxGraph& onnx, const Node& node);
void batch_norm_to_onnx(OnnxGraph& onnx, const Node& node);
// onnx_resampling.cpp
void adaptive_avg_pool_to_onnx(OnnxGraph& onnx, const Node& node);
void resize_bilinear_to_onnx(OnnxGraph& onnx, const Node& node);
// onnx_elementwise.cpp
void leaky_relu_to_onnx(OnnxGraph& onnx, const Node& node);
void sigmoid_to_onnx(OnnxGraph& onnx, const Node& node);
void softmax_to_onnx(OnnxGraph& onnx, const Node& node);
void affine_to_onnx(OnnxGraph& onnx, const Node& node);
void binary_to_onnx(OnnxGraph& onnx, const Node& node);
void reduce_sum_to_onnx(OnnxGraph& onnx, const Node& node);
void add_repeated_to_onnx(OnnxGraph& onnx, const Node& node);
void slot_masks_to_onnx(OnnxGraph& onnx, const Node& node);
void mask_centroid_to_onnx(OnnxGraph& onnx, const Node& node);
void decode_location_to_onnx(OnnxGraph& onnx, const Node& node);
void back_project_to_onnx(OnnxGraph& onnx, const Node& node);
// onnx_shapes.cpp
void relayout_to_onnx(OnnxGraph& onnx, const Node& node);
void concat_to_onnx(OnnxGraph& onnx, const Node& node);
void slice_to_onnx(OnnxGraph& onnx, const Node& node);
void crop_to_onnx(OnnxGraph& onnx, const Node& node);
void permute_to_onnx(OnnxGraph& onnx, const Node& node);

/// The op of a node, which has this type.
template <class T>
const T& op_of(const Node& node) {
  return dynamic_cast<const T&>(*node.op);
}

/// Tensors of a node's inputs.
inline std::vector<std::string> inputs_of(OnnxGraph& onnx, const Node& node) {
  std::vector<std::string> names;
  for (const int input : node.inputs) names.push_back(onnx.tensor(input));
  return names;
}

}  // namespace vkopple
