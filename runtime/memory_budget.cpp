#include "runtime/memory_budget.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/device.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

bool tells_budget(VkPhysicalDevice device) {
  uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr),
        "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data()),
        "vkEnumerateDeviceExtensionProperties");
  return std::any_of(extensions.begin(), extensions.end(), [](const VkExtensionProperties& e) {
    return std::string_view(e.extensionName) == VK_EXT_MEMORY_BUDGET_EXTENSION_NAME;
  });
}

/// Of the largest device-local heap.
uint64_t budget_left(VkPhysicalDevice device) {
  VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{};
  budget.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT;
  VkPhysicalDeviceMemoryProperties2 memory{};
  memory.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2;
  memory.pNext = &budget;
  vkGetPhysicalDeviceMemoryProperties2(device, &memory);
  uint64_t largest = 0, left = 0;
  for (uint32_t i = 0; i < memory.memoryProperties.memoryHeapCount; ++i) {
    const VkMemoryHeap& heap = memory.memoryProperties.memoryHeaps[i];
    if ((heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) == 0 || heap.size <= largest) continue;
    largest = heap.size;
    left = budget.heapBudget[i] - std::min(budget.heapBudget[i], budget.heapUsage[i]);
  }
  return left;
}

}  // namespace

std::optional<uint64_t> available_memory(std::istream& meminfo) {
  std::string field;
  while (meminfo >> field) {
    uint64_t kibibytes = 0;
    if (field == "MemAvailable:" && meminfo >> kibibytes) return kibibytes * 1024;
  }
  return std::nullopt;
}

uint64_t free_memory(const Device& device) {
  const Caps& caps = device.caps();
  if (caps.cpu()) {
    std::ifstream meminfo("/proc/meminfo");
    return available_memory(meminfo).value_or(caps.memory_bytes);
  }
  return tells_budget(device.physical()) ? budget_left(device.physical()) : caps.memory_bytes;
}

}  // namespace vkopple
