#pragma once

#include "models/layers.h"
#include "models/model_config.h"

namespace vkopple {

/// The imagination network (docs/model.md §2.3): masked image and log depth of every hypothesis, NC4HW4
/// (B·(K+1), 4, H, W), and its condition, row-major (B, K+1, 7 or 12), to NC4HW4 (B·(K+1), 5, H, W): three
/// colour logits, a depth logit and a mask logit.
Value imagination_net(LayerFactory& layers, const ModelConfig& config, Value x, Value condition);

}  // namespace vkopple
