#pragma once

#include <vulkan/vulkan.h>

#include <string_view>
#include <vector>

namespace vkopple {

/// Extensions that a device offers. Throws Error where the driver does.
std::vector<VkExtensionProperties> extensions_of(VkPhysicalDevice device);
bool has(const std::vector<VkExtensionProperties>& extensions, std::string_view name);

}  // namespace vkopple
