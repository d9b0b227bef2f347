#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string>

namespace vkopple::test {

/// While it lives, a call of Vulkan fails: that number `at` (counted from 0) of those to `call`
/// ("vkQueueSubmit") or, where that is empty, of those to all that tests/support/vulkan_faults.cpp stands in
/// for. A lost device stays lost to every call. One at a time. The program knows nothing of it: the tests'
/// executable has functions of its own in place of the loader's.
class VulkanFaults {
 public:
  VulkanFaults(std::string call, uint64_t at, VkResult result);
  ~VulkanFaults();
  VulkanFaults(const VulkanFaults&) = delete;
  VulkanFaults& operator=(const VulkanFaults&) = delete;

  /// Whether it came to that.
  bool hit() const { return hit_; }
  /// The calls that were counted.
  uint64_t calls() const { return calls_; }

  /// What a call is to return in place of doing its work; VK_SUCCESS: it is to do it.
  static VkResult next(const char* call);

 private:
  VkResult result_of(const char* call);

  std::string call_;
  uint64_t at_;
  VkResult result_;
  uint64_t calls_ = 0;
  bool hit_ = false;
};

}  // namespace vkopple::test
