#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace vkopple {

/// What one stretch of the shared memory holds from step `first` to step `last`.
struct MemoryUse {
  std::string what;  ///< "object/masks/up6_att conv2d, output 0"
  uint64_t bytes = 0;
  int64_t first = 0;
  int64_t last = 0;
};

/// The step at which most is held at once.
struct MemoryPeak {
  int64_t step = 0;
  uint64_t bytes = 0;
  std::vector<MemoryUse> held;  ///< then, largest first
};

MemoryPeak find_peak(std::span<const MemoryUse> uses);

}  // namespace vkopple
