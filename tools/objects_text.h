#pragma once

#include <optional>
#include <string>
#include <vector>

#include "train/seen_image.h"

namespace vkopple {

/// A table of a picture's objects, with their ids unless there are none: a line for its head and for every
/// slot.
std::string objects_text(const std::vector<SeenObject>& objects, const std::vector<std::optional<size_t>>& ids);

}  // namespace vkopple
