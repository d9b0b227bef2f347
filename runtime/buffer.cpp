#include "runtime/buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "runtime/arena_blocks.h"
#include "runtime/byte_text.h"
#include "runtime/device.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

constexpr VkMemoryPropertyFlags kVisible =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

std::optional<uint32_t> find_type(const VkPhysicalDeviceMemoryProperties& memory, uint32_t allowed,
                                  VkMemoryPropertyFlags flags) {
  for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
  return std::nullopt;
}

/// Device-local and visible where the two are one memory (a CPU, an integrated GPU); a discrete GPU's small
/// visible window is left to others.
uint32_t memory_type(const Device& device, uint32_t allowed, MemoryKind kind) {
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(device.physical(), &memory);
  const bool one_memory =
      device.caps().type == DeviceType::kCpu || device.caps().type == DeviceType::kIntegrated;
  std::optional<uint32_t> type;
  if (kind == MemoryKind::kDevice && one_memory)
    type = find_type(memory, allowed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | kVisible);
  if (!type && kind == MemoryKind::kDevice)
    type = find_type(memory, allowed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (!type && kind == MemoryKind::kHost)
    type = find_type(memory, allowed, kVisible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  if (!type && kind == MemoryKind::kHost) type = find_type(memory, allowed, kVisible);
  if (!type) type = find_type(memory, allowed, 0);
  if (!type) throw Error("the device has no memory for buffers");
  return *type;
}

}  // namespace

Buffer::Buffer(const Device& device, uint64_t bytes, MemoryKind kind, const std::string& name)
    : device_(&device), bytes_(std::max<uint64_t>(bytes, 16)) {
  try {
    allocate(kind, name);
  } catch (...) {
    release();
    throw;
  }
}

void Buffer::allocate(MemoryKind kind, const std::string& name) {
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
  check(vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
  device_->set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), name);
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device_->handle(), buffer_, &needs);
  VkMemoryAllocateInfo memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex = memory_type(*device_, needs.memoryTypeBits, kind);
  check(vkAllocateMemory(device_->handle(), &memory, nullptr, &memory_),
        fmt::format("vkAllocateMemory of {} MiB for {}", (needs.size + (1U << 20) - 1) >> 20, name));
  check(vkBindBufferMemory(device_->handle(), buffer_, memory_, 0), "vkBindBufferMemory");
  VkPhysicalDeviceMemoryProperties properties{};
  vkGetPhysicalDeviceMemoryProperties(device_->physical(), &properties);
  if ((properties.memoryTypes[memory.memoryTypeIndex].propertyFlags & kVisible) == kVisible) {
    void* pointer = nullptr;
    check(vkMapMemory(device_->handle(), memory_, 0, VK_WHOLE_SIZE, 0, &pointer), "vkMapMemory");
    mapped_ = static_cast<std::byte*>(pointer);
  }
}

void Buffer::release() {
  for (const auto& [key, view] : views_) vkDestroyBufferView(device_->handle(), view, nullptr);
  if (buffer_ != VK_NULL_HANDLE) vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  if (memory_ != VK_NULL_HANDLE) vkFreeMemory(device_->handle(), memory_, nullptr);
}

Buffer::~Buffer() { release(); }

VkBufferView Buffer::view(VkFormat format, uint64_t offset, uint64_t bytes) {
  VkBufferView& view = views_[{format, {offset, bytes}}];
  if (view == VK_NULL_HANDLE) {
    VkBufferViewCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
    info.buffer = buffer_;
    info.format = format;
    info.offset = offset;
    info.range = bytes;
    check(vkCreateBufferView(device_->handle(), &info, nullptr, &view), "vkCreateBufferView");
  }
  return view;
}

Arena::Arena(const Device& device, MemoryKind kind, std::string name, uint64_t block_bytes)
    : device_(&device),
      kind_(kind),
      name_(std::move(name)),
      block_bytes_(std::min(block_bytes, device.caps().max_allocation_bytes)) {}

Slice Arena::allocate(uint64_t bytes) {
  const Caps& caps = device_->caps();
  const ArenaBlocks::Place place =
      ArenaBlocks::place(caps, block_bytes_, blocks_.empty() ? 0 : blocks_.back()->bytes(), used_, bytes);
  if (place.new_block > caps.max_allocation_bytes)
    throw Error(fmt::format("{} needs {} in one piece, {} allows {}; use a smaller --batch or image size",
                            name_, byte_text(place.new_block), caps.name,
                            byte_text(caps.max_allocation_bytes)));
  if (place.new_block > 0) blocks_.push_back(std::make_unique<Buffer>(*device_, place.new_block, kind_, name_));
  used_ = place.used;
  return {blocks_.back().get(), place.offset, bytes};
}

uint64_t Arena::allocated_bytes() const {
  uint64_t sum = 0;
  for (const auto& block : blocks_) sum += block->bytes();
  return sum;
}

}  // namespace vkopple
