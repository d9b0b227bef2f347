#include "runtime/vulkan_error.h"

#include <fmt/format.h>

namespace vkopple {

std::string_view result_name(VkResult result) {
  switch (result) {
    case VK_SUCCESS:
      return "VK_SUCCESS";
    case VK_NOT_READY:
      return "VK_NOT_READY";
    case VK_TIMEOUT:
      return "VK_TIMEOUT";
    case VK_INCOMPLETE:
      return "VK_INCOMPLETE";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST:
      return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_MEMORY_MAP_FAILED:
      return "VK_ERROR_MEMORY_MAP_FAILED";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "VK_ERROR_TOO_MANY_OBJECTS";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "VK_ERROR_OUT_OF_POOL_MEMORY";
    default:
      return "an unknown VkResult";
  }
}

namespace {

std::string_view remedy(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "; use a smaller --batch or image size, or another --device";
    case VK_ERROR_DEVICE_LOST:
      return "; the driver gave up: run again, and look at the driver's log if it stays";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "; install a Vulkan driver (mesa-vulkan-drivers has one for the CPU)";
    default:
      return "";
  }
}

}  // namespace

VulkanError::VulkanError(VkResult result, std::string_view call)
    : Error(fmt::format("{} failed with {} ({}){}", call, result_name(result), static_cast<int>(result),
                        remedy(result))),
      result_(result) {}

void check(VkResult result, std::string_view call) {
  if (result != VK_SUCCESS) throw VulkanError(result, call);
}

}  // namespace vkopple
