#pragma once

#include "models/model_config.h"

namespace vkopple {

/// Operations, forward and backward, that one triplet costs a training step of the authors' graph: every frame
/// passes depth network and mask decoder, and the decoder sees the encoder's skips anew for each slot.
/// Convolutions and products count, a multiplication and an addition one each.
double authors_flop(const ModelConfig& config);

}  // namespace vkopple
