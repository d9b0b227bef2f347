#include "train/exchange/onnx/onnx_translators.h"

#include <algorithm>
#include <array>
#include <utility>

namespace vkopple {
namespace {

constexpr std::array<std::pair<std::string_view, OnnxTranslator>, 23> kTranslators{
    {{"adaptive_avg_pool", adaptive_avg_pool_to_onnx},
     {"add_repeated", add_repeated_to_onnx},
     {"affine", affine_to_onnx},
     {"back_project", back_project_to_onnx},
     {"batch_norm", batch_norm_to_onnx},
     {"binary", binary_to_onnx},
     {"concat", concat_to_onnx},
     {"conv2d", conv2d_to_onnx},
     {"conv_transpose2d", conv_transpose2d_to_onnx},
     {"crop", crop_to_onnx},
     {"decode_location", decode_location_to_onnx},
     {"leaky_relu", leaky_relu_to_onnx},
     {"linear", linear_to_onnx},
     {"lstm", lstm_to_onnx},
     {"mask_centroid", mask_centroid_to_onnx},
     {"permute", permute_to_onnx},
     {"reduce_sum", reduce_sum_to_onnx},
     {"relayout", relayout_to_onnx},
     {"resize_bilinear", resize_bilinear_to_onnx},
     {"sigmoid", sigmoid_to_onnx},
     {"slice", slice_to_onnx},
     {"slot_masks", slot_masks_to_onnx},
     {"softmax", softmax_to_onnx}}};

}  // namespace

OnnxTranslator find_onnx_translator(std::string_view op) {
  const auto* found = std::find_if(kTranslators.begin(), kTranslators.end(),
                                   [&](const auto& entry) { return entry.first == op; });
  return found == kTranslators.end() ? nullptr : found->second;
}

}  // namespace vkopple
