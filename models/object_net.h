#pragma once

#include "models/layers.h"
#include "models/model_config.h"

namespace vkopple {

/// What the object network says of F frames of B images each; row-major.
struct ObjectOutputs {
  Value raw;          ///< (F, B, K, 3 + bins + code), the slots' raw numbers
  Value mask_logits;  ///< (F, K, B, H, W), the background's is 0
};

/// The object-extraction network (docs/model.md §2.2): images NC4HW4 (F·B, 3, H, W), frame after frame. Each
/// frame, and in the mask decoder each frame and slot, has batch statistics of its own, in that order.
ObjectOutputs object_net(LayerFactory& layers, const ModelConfig& config, Value images, int64_t frames);

/// Bytes of the network's largest tensor for so many samples (F·K·B in the mask decoder).
uint64_t object_net_bytes(const ModelConfig& config, int64_t samples);

}  // namespace vkopple
