#include "runtime/memory_budget.h"

#include <algorithm>
#include <fstream>
#include <string>

#include "runtime/device.h"
#include "runtime/device_extensions.h"

namespace vkopple {
namespace {

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
    return std::min(available_memory(meminfo).value_or(caps.memory_bytes), caps.memory_bytes);
  }
  return has(extensions_of(device.physical()), VK_EXT_MEMORY_BUDGET_EXTENSION_NAME)
             ? budget_left(device.physical())
             : caps.memory_bytes;
}

}  // namespace vkopple
