#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "runtime/storage.h"

namespace vkopple {

class Device;
class Buffer;

/// A range of a buffer's bytes; what shaders are bound to. Empty where an optional operand is absent.
struct Slice {
  Buffer* buffer = nullptr;
  uint64_t offset = 0;  ///< bytes, a multiple of Caps::offset_alignment where it is bound
  uint64_t bytes = 0;
  Storage storage = Storage::kFloat32;

  explicit operator bool() const { return buffer != nullptr; }
  Slice sub(uint64_t begin, uint64_t length) const { return {buffer, offset + begin, length, storage}; }
  bool overlaps(const Slice& other) const {
    return buffer == other.buffer && offset < other.offset + other.bytes && other.offset < offset + bytes;
  }
};

enum class MemoryKind {
  kDevice,  ///< fastest for the device; host-visible too where the device's memory is (CPU, integrated)
  kHost,    ///< host-visible and coherent: staging
};

/// A Vulkan buffer with memory of its own, mapped where the host can see it.
class Buffer {
 public:
  Buffer(const Device& device, uint64_t bytes, MemoryKind kind, const std::string& name);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  VkBuffer handle() const { return buffer_; }
  uint64_t bytes() const { return bytes_; }
  /// Start of the memory; null where the host can't see it.
  std::byte* mapped() const { return mapped_; }
  Slice whole() { return {this, 0, bytes_}; }
  /// The texel view of a range; made once, kept as long as the buffer.
  VkBufferView view(VkFormat format, uint64_t offset, uint64_t bytes);

 private:
  void allocate(MemoryKind kind, const std::string& name);
  void release();

  const Device* device_;
  uint64_t bytes_ = 0;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::byte* mapped_ = nullptr;
  std::map<std::pair<VkFormat, std::pair<uint64_t, uint64_t>>, VkBufferView> views_;
};

/// Hands out slices of a few large buffers, front to back; all are freed together.
class Arena {
 public:
  /// block_bytes: size of one allocation; a larger request gets a block of its own.
  Arena(const Device& device, MemoryKind kind, std::string name, uint64_t block_bytes = uint64_t{64} << 20);
  /// Throws Error naming both sizes where the device can't hold it.
  Slice allocate(uint64_t bytes);
  uint64_t allocated_bytes() const;

 private:
  const Device* device_;
  MemoryKind kind_;
  std::string name_;
  uint64_t block_bytes_;
  uint64_t used_ = 0;
  std::vector<std::unique_ptr<Buffer>> blocks_;
};

}  // namespace vkopple
