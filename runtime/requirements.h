#pragma once

#include <cstdint>

namespace vkopple {

/// What every device must allow, beside Vulkan 1.1 with compute (runtime/inspect.cpp).
constexpr uint32_t kPushConstantBytes = 128;  ///< Vulkan's least
constexpr uint32_t kMostBindings = 10;        ///< storage buffers of a shader; Vulkan's least would be 4

}  // namespace vkopple
