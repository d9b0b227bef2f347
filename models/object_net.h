#pragma once

#include <vector>

#include "models/layers.h"
#include "models/model_config.h"

namespace vkopple {

/// What the object network says of one frame of B images; row-major.
struct ObjectOutputs {
  Value raw;          ///< (B, K, 3 + orientation + code), the slots' raw numbers
  Value mask_logits;  ///< (K, B, H, W), the background's is 0; empty where masks weren't asked for
};

/// The object-extraction network (docs/model.md §2.2): images NC4HW4 (F·B, 3, H, W), frame after frame. Each
/// frame, and in the mask decoder each slot of it unless `mask_statistics` says otherwise, has batch statistics
/// of its own, in that order. Frames with `masks` pass the decoder, each in a call of its own: backward goes
/// through none but those that the loss needs.
std::vector<ObjectOutputs> object_net(LayerFactory& layers, const ModelConfig& config, Value images,
                                      const std::vector<bool>& masks);
}  // namespace vkopple
