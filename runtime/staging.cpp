#include "runtime/staging.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "runtime/device.h"
#include "runtime/memory_barrier.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

constexpr uint64_t kLeastBytes = uint64_t{1} << 16;
constexpr uint64_t kMostBytes = uint64_t{32} << 20;

}  // namespace

Staging::~Staging() {
  if (fence_ != VK_NULL_HANDLE) vkDestroyFence(device_->handle(), fence_, nullptr);
  if (pool_ != VK_NULL_HANDLE) vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

Slice Staging::part(uint64_t bytes) {
  if (!buffer_ || buffer_->bytes() < bytes) {
    buffer_.reset();
    buffer_ = std::make_unique<Buffer>(*device_, std::max(std::bit_ceil(bytes), kLeastBytes), MemoryKind::kHost,
                                       "staging");
  }
  return buffer_->whole().sub(0, bytes);
}

void Staging::prepare() {
  if (pool_ == VK_NULL_HANDLE) {
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool.queueFamilyIndex = device_->queue_family();
    check(vkCreateCommandPool(device_->handle(), &pool, nullptr, &pool_), "vkCreateCommandPool");
  }
  if (commands_ == VK_NULL_HANDLE) {
    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device_->handle(), &allocate, &commands_), "vkAllocateCommandBuffers");
  }
  if (fence_ == VK_NULL_HANDLE) {
    VkFenceCreateInfo fence{};
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    check(vkCreateFence(device_->handle(), &fence, nullptr, &fence_), "vkCreateFence");
  }
}

void Staging::copy(const Slice& from, const Slice& to) {
  prepare();
  check(vkResetCommandPool(device_->handle(), pool_, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
  wait_for_all_before(commands_);
  const VkBufferCopy region{from.offset, to.offset, from.bytes};
  vkCmdCopyBuffer(commands_, from.buffer->handle(), to.buffer->handle(), 1, &region);
  show_to_host(commands_);
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands_;
  check(vkQueueSubmit(device_->queue(), 1, &submit, fence_), "vkQueueSubmit");
  check(vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  check(vkResetFences(device_->handle(), 1, &fence_), "vkResetFences");
}

void Staging::upload(const Slice& to, std::span<const std::byte> data) {
  for (uint64_t at = 0; at < data.size(); at += kMostBytes) {
    const Slice staged = part(std::min<uint64_t>(kMostBytes, data.size() - at));
    std::memcpy(staged.buffer->mapped(), data.data() + at, staged.bytes);
    copy(staged, to.sub(at, staged.bytes));
  }
}

void Staging::download(const Slice& from, std::span<std::byte> data) {
  for (uint64_t at = 0; at < data.size(); at += kMostBytes) {
    const Slice staged = part(std::min<uint64_t>(kMostBytes, data.size() - at));
    copy(from.sub(at, staged.bytes), staged);
    std::memcpy(data.data() + at, staged.buffer->mapped(), staged.bytes);
  }
}

}  // namespace vkopple
