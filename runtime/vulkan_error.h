#pragma once

#include <vulkan/vulkan.h>

#include <string_view>

#include "runtime/error.h"

namespace vkopple {

/// A Vulkan call failed; the message names the call, the result and, where there is one, the remedy.
class VulkanError : public Error {
 public:
  VulkanError(VkResult result, std::string_view call);
  VkResult result() const { return result_; }

 private:
  VkResult result_;
};

std::string_view result_name(VkResult result);

/// Throws VulkanError unless `result` is VK_SUCCESS.
void check(VkResult result, std::string_view call);

}  // namespace vkopple
