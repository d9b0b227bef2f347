#pragma once

#include "models/layers.h"
#include "models/model_config.h"

namespace vkopple {

/// The depth network (docs/model.md §2.1): images, NC4HW4 (B, 3, H, W), to depth in scene units,
/// row-major (B, 1, H, W).
Value depth_net(LayerFactory& layers, const ModelConfig& config, Value images);

}  // namespace vkopple
