#include <fmt/format.h>

#include "graph/executor.h"
#include "runtime/device.h"
#include "runtime/error.h"

namespace vkopple {

GroupStore::GroupStore(const Device& device)
    : device_(&device), arena_(device, MemoryKind::kDevice, "parameters and state", kGroupBlockBytes) {}

Slice GroupStore::get(const std::string& name, uint64_t bytes) {
  const auto [entry, added] = slices_.try_emplace(name);
  if (added) {
    entry->second = arena_.allocate(bytes);
    Recorder recorder(*device_);
    recorder.fill(entry->second);
    recorder.finish()->run();
  } else if (entry->second.bytes != bytes) {
    throw Error(
        fmt::format("group {} has {} bytes in one graph and {} in another", name, entry->second.bytes, bytes));
  }
  return entry->second;
}

}  // namespace vkopple
