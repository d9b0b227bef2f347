#pragma once

#include <cstdint>
#include <optional>

namespace vkopple {

/// Memory of this process that lies in the machine's, in bytes.
struct ResidentMemory {
  uint64_t now = 0;
  uint64_t peak = 0;  ///< since the process began
};

/// Nothing where the system does not tell (it is Linux's /proc/self/status).
std::optional<ResidentMemory> resident_memory();

}  // namespace vkopple
