#pragma once

#include <string>

#include "models/layers.h"
#include "models/model_config.h"

namespace vkopple {

/// What the layers of "depth", "object", "imagination" or "motion" share (docs/model.md §2, §11). `random` may
/// be empty where nothing is dropped.
NetworkOptions network_options(const ModelConfig& config, const std::string& group, bool training, Value random,
                               uint64_t max_tensor_bytes);

}  // namespace vkopple
