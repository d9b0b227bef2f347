#pragma once

#include <string>

#include "models/config.h"

namespace vkopple {

/// The rooms of the stage of that name. Throws UsageError naming those that there are.
RoomsConfig rooms_of_stage(const Config& config, const std::string& name);

}  // namespace vkopple
