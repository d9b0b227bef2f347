#include "runtime/device.h"

#include <cstdlib>
#include <vector>

#include "runtime/cooperative_matrix.h"
#include "runtime/pipeline.h"
#include "runtime/staging.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

/// Views at least this long serve every tensor that a storage binding reaches on the devices with small
/// bindings.
constexpr uint64_t kLargeTexelBuffer = uint64_t{1} << 26;

uint32_t compute_family(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (uint32_t i = 0; i < count; ++i)
    if ((families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) != 0) return i;
  throw Error("the device has no compute queue");
}

}  // namespace

std::string missing_for(KernelFamily family, const Caps& caps) {
  if (family == KernelFamily::kCooperative && caps.cooperative_matrices.empty())
    return "kernels 'cooperative' can't run on " + caps.name +
           ": they need VK_KHR_cooperative_matrix with products of float16 added in float32; leave the choice "
           "to the device";
  if (family != KernelFamily::kRegisters) return {};
  // A workgroup must be one subgroup, and hold the weights of 8 output channels.
  const uint32_t size = caps.subgroup_size;
  if (caps.cpu() && caps.subgroup_shuffle && size >= 8 && size <= 128 && (size & (size - 1)) == 0) return {};
  return "kernels 'registers' can't run on " + caps.name +
         ": they need a CPU device with shuffles among 8 to 128 lanes; leave the choice to the device";
}

std::string missing_for(AccessPath access, const Caps& caps) {
  const bool large = caps.max_texel_elements >= kLargeTexelBuffer;
  if (access == AccessPath::kStorage || (caps.int64 && caps.subgroup_shuffle && large)) return {};
  return "the texel access path can't be had on " + caps.name +
         ": it needs subgroups that exchange 64-bit integers and texel buffers of 2^26 elements; leave the "
         "choice to the device";
}

std::string missing_for(WinogradUse use, const Caps& caps) {
  if (use == WinogradUse::kNever || use == WinogradUse::kWhereFaster) return {};
  if (caps.exact_sums)
    return "Winograd's algorithm can't keep what sums round off; take plain sums, or leave the choice to the "
           "device";
  if (caps.subgroup_shuffle && caps.subgroup_size >= 8 && caps.subgroup_size <= 128) return {};
  return "Winograd's algorithm can't run on " + caps.name +
         ": it needs shuffles among 8 to 128 lanes; leave the choice to the device";
}

std::filesystem::path default_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
    return std::filesystem::path(cache) / "vkopple";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "vkopple";
  return {};
}

Device::Device(DeviceOptions options) : instance_(std::move(options.on_message)) {
  const auto candidates = instance_.candidates();
  const size_t index = choose_device(candidates, device_selector(options.selector));
  physical_ = instance_.physical_devices().at(index);
  caps_ = candidates[index].caps;
  if (options.access) {
    if (const std::string why = missing_for(*options.access, caps_); !why.empty()) throw Error(why);
    caps_.access = *options.access;
  }
  caps_.row_stores = options.row_stores.value_or(caps_.row_stores) && caps_.access == AccessPath::kTexel;
  caps_.long_work = options.long_work;
  caps_.exact_sums = options.exact_sums;
  caps_.kernels = options.kernels;
  if (const std::string why = missing_for(caps_.kernels, caps_); !why.empty()) throw Error(why);
  caps_.winograd = options.winograd;
  if (const std::string why = missing_for(caps_.winograd, caps_); !why.empty()) throw Error(why);
  if (options.tuned) caps_.tuned = options.tuned(caps_);
  create_logical_device();
  const auto folder = options.cache_folder.empty() ? default_cache_folder() : options.cache_folder;
  pipelines_ = std::make_unique<PipelineSet>(*this, options.use_cache ? folder : std::filesystem::path());
  staging_ = std::make_unique<Staging>(*this);
}

void Device::create_logical_device() {
  queue_family_ = compute_family(physical_);
  const float priority = 1.0F;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceFeatures features{};
  features.shaderInt64 = caps_.int64 ? VK_TRUE : VK_FALSE;
  // In every build: every device has it, and zeros outside of texel buffers (access.glsl) are only promised
  // with it.
  features.robustBufferAccess = VK_TRUE;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.pEnabledFeatures = &features;
  std::vector<const char*> extensions;
  CooperativeFeatures cooperative;
  cooperative.enable();
  if (!caps_.cooperative_matrices.empty()) {
    info.pNext = cooperative.chain();
    extensions.assign(CooperativeFeatures::kExtensions.begin(), CooperativeFeatures::kExtensions.end());
  }
  VkPhysicalDeviceShaderSubgroupExtendedTypesFeatures exchanged{};
  exchanged.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_SUBGROUP_EXTENDED_TYPES_FEATURES;
  exchanged.shaderSubgroupExtendedTypes = VK_TRUE;
  if (caps_.int64) {
    exchanged.pNext = const_cast<void*>(info.pNext);
    info.pNext = &exchanged;
    extensions.push_back(VK_KHR_SHADER_SUBGROUP_EXTENDED_TYPES_EXTENSION_NAME);
  }
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  if (instance_.validates())
    set_name_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
        vkGetDeviceProcAddr(device_, "vkSetDebugUtilsObjectNameEXT"));
}

Device::~Device() {
  if (device_ == VK_NULL_HANDLE) return;
  vkDeviceWaitIdle(device_);
  staging_.reset();
  pipelines_.reset();
  vkDestroyDevice(device_, nullptr);
}

void Device::set_name(VkObjectType type, uint64_t handle, const std::string& name) const {
  if (set_name_ == nullptr) return;
  VkDebugUtilsObjectNameInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT;
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = name.c_str();
  set_name_(device_, &info);
}

}  // namespace vkopple
