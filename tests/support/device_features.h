#pragma once

#include <vulkan/vulkan.h>

namespace vkopple::test {

/// What the device that this thread created last was asked for. The tests' executable has a function of its own
/// in place of the loader's.
const VkPhysicalDeviceFeatures& features_asked_for();

}  // namespace vkopple::test
