#pragma once

#include <vulkan/vulkan.h>

#include <memory>
#include <span>

#include "runtime/buffer.h"

namespace vkopple {

/// Copies between the host and memory that only the device sees. Its buffer and its commands are made at the
/// first use and kept: a driver takes longer to make them than to copy the few numbers of most transfers.
/// For one thread at a time, as the device's queue is.
class Staging {
 public:
  explicit Staging(const Device& device) : device_(&device) {}
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  /// All three wait until the copy is done. Throw VulkanError.
  void upload(const Slice& to, std::span<const std::byte> data);
  void download(const Slice& from, std::span<std::byte> data);
  void copy(const Slice& from, const Slice& to);

 private:
  /// `bytes` of the mapped buffer, which grows to hold them.
  Slice part(uint64_t bytes);
  void prepare();

  const Device* device_;
  std::unique_ptr<Buffer> buffer_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
};

}  // namespace vkopple
