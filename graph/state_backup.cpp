#include "graph/state_backup.h"

#include <algorithm>

namespace vkopple {
namespace {

constexpr uint64_t kLargestBlock = uint64_t{4} << 20;

uint64_t block_bytes(const std::vector<Slice>& tensors) {
  uint64_t bytes = 0;
  for (const Slice& tensor : tensors) bytes += tensor.bytes;
  return std::min(bytes, kLargestBlock);
}

}  // namespace

StateBackup::StateBackup(const Device& device, const std::vector<Slice>& tensors)
    : arena_(device, MemoryKind::kDevice, "copy of running averages", block_bytes(tensors)) {
  Recorder keep(device);
  Recorder restore(device);
  for (const Slice& tensor : tensors) {
    const Slice copy = arena_.allocate(tensor.bytes);
    keep.copy(tensor, copy);
    restore.copy(copy, tensor);
  }
  keep_ = keep.finish();
  restore_ = restore.finish();
}

}  // namespace vkopple
