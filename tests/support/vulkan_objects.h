#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace vkopple::test {

/// What this process has of Vulkan at the moment, as tests/support/vulkan_faults.cpp saw it come and go:
/// objects by kind ("buffers", "descriptor sets", ...). The program knows nothing of it.
struct VulkanObjects {
  uint64_t memory_bytes = 0;  ///< of device memory
  std::map<std::string, uint64_t> counts;

  static VulkanObjects now();
};

// What the functions that stand in for the loader's tell, from any thread.

/// What an object is, by kind and handle: handles of different kinds may be alike.
using VulkanObject = std::pair<std::string_view, uint64_t>;

/// One was made, and is one of its parent's (descriptor sets of a pool), which ends it; or it is nobody's.
void note_made(const VulkanObject& object, const VulkanObject& parent = {}, uint64_t bytes = 0);
/// One was destroyed, and with it those that have it as their parent. Nothing where it is not known.
void note_gone(const VulkanObject& object);

/// `kind` outlives all.
template <class Handle>
VulkanObject vulkan_object(const char* kind, Handle handle) {
  return {kind, reinterpret_cast<uint64_t>(handle)};
}

}  // namespace vkopple::test
