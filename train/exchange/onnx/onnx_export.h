#pragma once

#include <cstdint>
#include <filesystem>

#include "train/exchange/model_weights.h"

namespace vkopple {

/// Writes the networks on single images as an ONNX model of opset 17, through AtomicFile: input "images" (B, 3,
/// H, W) in [0, 1]; outputs "depth" (B, 1, H, W), "masks" (B, K+1, H, W) with the background last, "location"
/// (B, K, 3), "log_pose" (B, K, bins) and "code" (B, K, code); sizes are fixed. The checkpoint's metadata go
/// along. `bgr`: images are blue, green, red. Throws Error for a model with 3D rotation, which can't be
/// exported yet, and where an op of the model has no form in ONNX.
void export_onnx(const std::filesystem::path& path, const ModelWeights& weights, std::int64_t batch, bool bgr);

}  // namespace vkopple
