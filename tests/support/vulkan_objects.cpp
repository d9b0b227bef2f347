#include "tests/support/vulkan_objects.h"

#include <mutex>
#include <set>

namespace vkopple::test {
namespace {

struct Made {
  VulkanObject parent;
  uint64_t bytes = 0;
  std::set<VulkanObject> children;
};

// The functions that stand in for the loader's belong to no object.
std::mutex mutex;
std::map<VulkanObject, Made> all;

void forget(const VulkanObject& object) {
  const auto found = all.find(object);
  if (found == all.end()) return;
  const Made made = std::move(found->second);
  all.erase(found);
  if (const auto parent = all.find(made.parent); parent != all.end()) parent->second.children.erase(object);
  for (const VulkanObject& child : made.children) forget(child);
}

}  // namespace

VulkanObjects VulkanObjects::now() {
  const std::lock_guard lock(mutex);
  VulkanObjects objects;
  for (const auto& [object, made] : all) {
    ++objects.counts[std::string(object.first)];
    objects.memory_bytes += made.bytes;
  }
  return objects;
}

void note_made(const VulkanObject& object, const VulkanObject& parent, uint64_t bytes) {
  const std::lock_guard lock(mutex);
  all[object] = {.parent = parent, .bytes = bytes, .children = {}};
  if (const auto found = all.find(parent); found != all.end()) found->second.children.insert(object);
}

void note_gone(const VulkanObject& object) {
  const std::lock_guard lock(mutex);
  forget(object);
}

}  // namespace vkopple::test
