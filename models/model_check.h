#pragma once

#include <string>
#include <vector>

#include "models/model_config.h"

namespace vkopple {

class Device;

/// The derivative of the total loss along one direction in one network's parameters.
struct DirectionalCheck {
  std::string group;      ///< "depth", "object", "imagination", "motion"
  std::string direction;  ///< "gradient" or "random"
  double analytic = 0;    ///< gradient · direction, from the backward pass
  double numeric = 0;     ///< central difference of the forward pass
  double limit =
      0;  ///< of the difference: relative to the gradient's length, which float32 forward passes allow
  bool passed() const;
};

/// A model that is worth a check of its own: a variant, or sizes that are not the usual ones.
struct CheckedModel {
  std::string name;
  ModelConfig config;
};
/// Small enough for differences to take seconds.
std::vector<CheckedModel> checked_models();

/// Checks the whole model at once, on made-up images: what single ops' checks can't see is how they
/// are put together. Batch norm uses running averages: over the three numbers of a 1×1 map, batch statistics
/// bend the loss more within a few float32 spacings than differences can follow (the training fixture pins them
/// instead).
std::vector<DirectionalCheck> check_model(const Device& device, const ModelConfig& config);

}  // namespace vkopple
