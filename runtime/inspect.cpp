#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "runtime/cooperative_matrix.h"
#include "runtime/device_extensions.h"
#include "runtime/instance.h"
#include "runtime/quirks.h"
#include "runtime/requirements.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

constexpr uint32_t kMostRowLanes = 16;  ///< kMostLanes of row_store.glsl

DeviceType type_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceType::kDiscrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceType::kIntegrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceType::kVirtual;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceType::kCpu;
    default:
      return DeviceType::kOther;
  }
}

bool has_compute_queue(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return std::any_of(families.begin(), families.end(), [](const VkQueueFamilyProperties& f) {
    return (f.queueFlags & VK_QUEUE_COMPUTE_BIT) != 0;
  });
}

void read_limits(const VkPhysicalDeviceLimits& limits, Caps& caps) {
  caps.max_storage_range = limits.maxStorageBufferRange;
  caps.max_texel_elements = limits.maxTexelBufferElements;
  caps.offset_alignment =
      std::max<uint64_t>({limits.minStorageBufferOffsetAlignment, limits.minTexelBufferOffsetAlignment, 256});
  caps.max_workgroup_size = std::min(limits.maxComputeWorkGroupInvocations, limits.maxComputeWorkGroupSize[0]);
  std::copy_n(limits.maxComputeWorkGroupCount, 3, caps.max_groups.begin());
  caps.shared_memory_bytes = limits.maxComputeSharedMemorySize;
  caps.timestamp_period = limits.timestampComputeAndGraphics != VK_FALSE ? limits.timestampPeriod : 0.0F;
}

void read_memory(VkPhysicalDevice device, Caps& caps) {
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  if (caps.lavapipe) {
    // lavapipe calls its heap 2 GiB whatever the machine has, and allocates beyond it.
    caps.memory_bytes =
        static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    return;
  }
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if ((memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
      caps.memory_bytes = std::max<uint64_t>(caps.memory_bytes, memory.memoryHeaps[i].size);
}

/// SwiftShader tells its version as a number alone, packed like Vulkan's.
std::string version_text(const VkPhysicalDeviceDriverProperties& driver, const VkPhysicalDeviceProperties& p) {
  if (driver.driverInfo[0] != '\0') return driver.driverInfo;
  return fmt::format("{}.{}.{}", VK_VERSION_MAJOR(p.driverVersion), VK_VERSION_MINOR(p.driverVersion),
                     VK_VERSION_PATCH(p.driverVersion));
}

void read_properties(VkPhysicalDevice device, bool has_driver_properties, Caps& caps) {
  VkPhysicalDeviceMaintenance3Properties maintenance3{};
  maintenance3.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  VkPhysicalDeviceSubgroupProperties subgroup{};
  subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  subgroup.pNext = &maintenance3;
  VkPhysicalDeviceIDProperties id{};
  id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES;
  id.pNext = &subgroup;
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  driver.pNext = &id;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = has_driver_properties ? static_cast<void*>(&driver) : static_cast<void*>(&id);
  vkGetPhysicalDeviceProperties2(device, &properties);

  const auto& p = properties.properties;
  caps.name = p.deviceName;
  caps.driver = has_driver_properties ? fmt::format("{} {}", driver.driverName, version_text(driver, p))
                                      : fmt::format("driver {:#x}", p.driverVersion);
  std::memcpy(caps.uuid.data(), id.deviceUUID, caps.uuid.size());
  std::memcpy(caps.driver_uuid.data(), id.driverUUID, caps.driver_uuid.size());
  caps.vendor_id = p.vendorID;
  caps.device_id = p.deviceID;
  caps.driver_version = p.driverVersion;
  caps.api_version = p.apiVersion;
  caps.type = type_of(p.deviceType);
  caps.max_allocation_bytes = maintenance3.maxMemoryAllocationSize;
  caps.subgroup_size = subgroup.subgroupSize;
  if ((subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0) {
    caps.subgroup_shuffle = (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT) != 0;
    caps.subgroup_arithmetic = (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_ARITHMETIC_BIT) != 0;
  }
  caps.lavapipe = has_driver_properties && driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
  caps.row_stores = caps.lavapipe && caps.subgroup_shuffle && caps.subgroup_size <= kMostRowLanes &&
                    stores_uniform_addresses_once(driver.driverInfo);
  read_limits(p.limits, caps);
}

/// Of a device that has VK_KHR_shader_subgroup_extended_types.
bool has_int64(VkPhysicalDevice device) {
  VkPhysicalDeviceShaderSubgroupExtendedTypesFeatures subgroups{};
  subgroups.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_SUBGROUP_EXTENDED_TYPES_FEATURES;
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &subgroups;
  vkGetPhysicalDeviceFeatures2(device, &features);
  return features.features.shaderInt64 != VK_FALSE && subgroups.shaderSubgroupExtendedTypes != VK_FALSE;
}

}  // namespace

Candidate inspect(VkInstance instance, VkPhysicalDevice device) {
  Candidate found;
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device, &properties);
  if (properties.apiVersion < VK_API_VERSION_1_1) {
    found.caps.name = properties.deviceName;
    found.missing.emplace_back("Vulkan 1.1");
    return found;
  }
  const auto extensions = extensions_of(device);
  read_properties(
      device,
      has(extensions, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME) || properties.apiVersion >= VK_API_VERSION_1_2,
      found.caps);
  read_memory(device, found.caps);
  found.caps.int64 = has(extensions, VK_KHR_SHADER_SUBGROUP_EXTENDED_TYPES_EXTENSION_NAME) && has_int64(device);
  found.caps.float_atomic_add = has(extensions, VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME);
  const auto& cooperative = CooperativeFeatures::kExtensions;
  if (std::all_of(cooperative.begin(), cooperative.end(), [&](const char* e) { return has(extensions, e); }))
    found.caps.cooperative_matrices = query_cooperative_matrices(instance, device);
  const bool texel = missing_for(AccessPath::kTexel, found.caps).empty();
  // Texel reads pay on CPU devices; GPUs cache storage buffers just as well.
  found.caps.access = texel && found.caps.cpu() ? AccessPath::kTexel : AccessPath::kStorage;
  if (!has_compute_queue(device)) found.missing.emplace_back("a compute queue");
  if (properties.limits.maxPushConstantsSize < kPushConstantBytes)
    found.missing.emplace_back(fmt::format("{} bytes of push constants", kPushConstantBytes));
  if (properties.limits.maxPerStageDescriptorStorageBuffers < kMostBindings)
    found.missing.emplace_back(fmt::format("{} storage buffers in a shader", kMostBindings));
  return found;
}

}  // namespace vkopple
