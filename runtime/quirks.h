#pragma once

#include <string_view>

#include "runtime/caps.h"

namespace vkopple {

/// Whether lavapipe of this VkPhysicalDeviceDriverProperties::driverInfo ("Mesa 22.3.6 (LLVM 15.0.6)") stores
/// the first lane's value alone where an address is made of push constants (shaders/include/row_store.glsl).
/// True of versions that this was measured on; elsewhere a row would cost as many loops as it has lanes.
inline bool stores_uniform_addresses_once(std::string_view driver_info) {
  return driver_info.starts_with("Mesa 22.3.");
}

/// Whether fma() in a shader keeps its product exact (shaders/include/product_remainder.glsl). SwiftShader's
/// and lavapipe's round it, as Vulkan allows; so may that of any other driver for CPUs.
inline bool fuses_products(const Caps& caps) { return !caps.cpu(); }

/// Whether a driver compiles kernels of tens of thousands of instructions. SwiftShader takes 15 GB and more to
/// do it.
inline bool compiles_long_kernels(const Caps& caps) { return !caps.cpu() || caps.lavapipe; }

}  // namespace vkopple
