#include "train/resident_memory.h"

#include <fstream>
#include <string>

namespace vkopple {

std::optional<ResidentMemory> resident_memory() {
  std::ifstream status("/proc/self/status");
  ResidentMemory memory;
  std::string field;
  while (status >> field) {
    uint64_t kibibytes = 0;
    if (field == "VmHWM:" && status >> kibibytes) memory.peak = kibibytes * 1024;
    if (field == "VmRSS:" && status >> kibibytes) memory.now = kibibytes * 1024;
  }
  if (memory.now == 0 || memory.peak == 0) return std::nullopt;
  return memory;
}

}  // namespace vkopple
