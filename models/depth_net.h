#pragma once

#include "models/layers.h"
#include "models/model_config.h"

namespace vkopple {

/// The depth network (docs/model.md §2.1): images, NC4HW4 (F·B, 3, H, W) of F frames one after the other, to
/// depth in scene units, row-major (F·B, 1, H, W). `frames`: F; each has batch statistics of its own.
Value depth_net(LayerFactory& layers, const ModelConfig& config, Value images, int64_t frames);

}  // namespace vkopple
