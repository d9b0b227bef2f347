#include "tests/support/device_features.h"

#include <dlfcn.h>

namespace vkopple::test {
namespace {

// vkCreateDevice below is called from anywhere.
thread_local VkPhysicalDeviceFeatures last{};

}  // namespace

const VkPhysicalDeviceFeatures& features_asked_for() { return last; }

}  // namespace vkopple::test

extern "C" VKAPI_ATTR VkResult VKAPI_CALL vkCreateDevice(VkPhysicalDevice physical,
                                                         const VkDeviceCreateInfo* info,
                                                         const VkAllocationCallbacks* callbacks,
                                                         VkDevice* device) {
  static const auto loader = reinterpret_cast<decltype(&vkCreateDevice)>(::dlsym(RTLD_NEXT, "vkCreateDevice"));
  vkopple::test::last =
      info->pEnabledFeatures == nullptr ? VkPhysicalDeviceFeatures{} : *info->pEnabledFeatures;
  return loader(physical, info, callbacks, device);
}
