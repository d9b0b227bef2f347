#pragma once

#include <vector>

#include "train/checkpoint.h"

namespace vkopple {

/// Whether a network has learned in any stage up to the checkpoint's. What others say is noise.
bool has_learned(const LoadedModel& model, Network network);

/// Warns where a network that is needed has not learned yet.
void warn_if_untrained(const LoadedModel& model, const std::vector<Network>& needed);

}  // namespace vkopple
