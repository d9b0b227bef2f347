#include "graph/memory_use.h"

#include <algorithm>
#include <map>

namespace vkopple {

MemoryPeak find_peak(std::span<const MemoryUse> uses) {
  struct Change {
    uint64_t more = 0;
    uint64_t less = 0;
  };
  std::map<int64_t, Change> changes;
  for (const MemoryUse& use : uses) {
    changes[use.first].more += use.bytes;
    changes[use.last + 1].less += use.bytes;
  }
  MemoryPeak peak;
  uint64_t held = 0;
  for (const auto& [step, change] : changes) {
    held = held + change.more - change.less;
    if (held > peak.bytes) {
      peak.bytes = held;
      peak.step = step;
    }
  }
  for (const MemoryUse& use : uses)
    if (use.first <= peak.step && peak.step <= use.last) peak.held.push_back(use);
  std::stable_sort(peak.held.begin(), peak.held.end(),
                   [](const MemoryUse& a, const MemoryUse& b) { return a.bytes > b.bytes; });
  return peak;
}

}  // namespace vkopple
