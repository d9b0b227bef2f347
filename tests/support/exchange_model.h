#pragma once

#include "train/exchange/model_weights.h"

namespace vkopple::test {

/// Weights of the tiny model with drawn parameters and running averages of their own, and counts in the batch
/// norms' counters; needs no device.
ModelWeights drawn_weights();

}  // namespace vkopple::test
