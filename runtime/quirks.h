#pragma once

#include <string_view>

namespace vkopple {

/// Whether lavapipe of this VkPhysicalDeviceDriverProperties::driverInfo ("Mesa 22.3.6 (LLVM 15.0.6)") stores
/// the first lane's value alone where an address is made of push constants (shaders/include/row_store.glsl).
/// True of versions that this was measured on; elsewhere a row would cost as many loops as it has lanes.
inline bool stores_uniform_addresses_once(std::string_view driver_info) {
  return driver_info.starts_with("Mesa 22.3.");
}

}  // namespace vkopple
