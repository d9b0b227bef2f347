#pragma once

#include <cstdint>
#include <istream>
#include <optional>

namespace vkopple {

class Device;

/// Bytes of memory that the machine can give without swapping, from the text of Linux's /proc/meminfo
/// ("MemAvailable"); nothing where it does not say.
std::optional<uint64_t> available_memory(std::istream& meminfo);

/// Bytes that buffers of this process can still take of a device now: of a CPU the machine's available memory,
/// but no more than the driver's heap (SwiftShader's has 2 GiB); of others what the driver has as this
/// process's budget (VK_EXT_memory_budget) less what it uses already. Where neither is told, all that the
/// device has (Caps::memory_bytes).
uint64_t free_memory(const Device& device);

}  // namespace vkopple
