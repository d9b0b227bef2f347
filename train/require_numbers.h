#pragma once

#include <span>

namespace vkopple {

/// Throws Error where something that a model infers is not a finite number.
void require_numbers(std::span<const float> values);

}  // namespace vkopple
