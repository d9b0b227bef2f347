#include "tests/support/vulkan_faults.h"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace vkopple::test {
namespace {

// The functions below are called from anywhere.
VulkanFaults* active = nullptr;

template <class Function>
Function real(Function, const char* name) {
  void* const found = ::dlsym(RTLD_NEXT, name);
  if (found == nullptr) {
    std::fprintf(stderr, "the loader has no %s\n", name);
    std::abort();
  }
  return reinterpret_cast<Function>(found);
}

}  // namespace

VulkanFaults::VulkanFaults(std::string call, uint64_t at, VkResult result)
    : call_(std::move(call)), at_(at), result_(result) {
  active = this;
}

VulkanFaults::~VulkanFaults() { active = nullptr; }

VkResult VulkanFaults::next(const char* call) {
  return active == nullptr ? VK_SUCCESS : active->result_of(call);
}

VkResult VulkanFaults::result_of(const char* call) {
  if (hit_ && result_ == VK_ERROR_DEVICE_LOST) return result_;
  if (!call_.empty() && call_ != call) return VK_SUCCESS;
  if (calls_++ != at_) return VK_SUCCESS;
  hit_ = true;
  return result_;
}

}  // namespace vkopple::test

using vkopple::test::real;
using vkopple::test::VulkanFaults;

// Each in place of the loader's function of that name.
#define VKOPPLE_FAULTY(name, parameters, arguments)           \
  extern "C" VKAPI_ATTR VkResult VKAPI_CALL name parameters { \
    static const auto loader = real(&name, #name);            \
    const VkResult fault = VulkanFaults::next(#name);         \
    return fault == VK_SUCCESS ? loader arguments : fault;    \
  }

VKOPPLE_FAULTY(vkCreateBuffer,
               (VkDevice device, const VkBufferCreateInfo* info, const VkAllocationCallbacks* callbacks,
                VkBuffer* buffer),
               (device, info, callbacks, buffer))
VKOPPLE_FAULTY(vkAllocateMemory,
               (VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* callbacks,
                VkDeviceMemory* memory),
               (device, info, callbacks, memory))
VKOPPLE_FAULTY(vkBindBufferMemory,
               (VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset),
               (device, buffer, memory, offset))
VKOPPLE_FAULTY(vkMapMemory,
               (VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
                VkMemoryMapFlags flags, void** data),
               (device, memory, offset, size, flags, data))
VKOPPLE_FAULTY(vkCreateBufferView,
               (VkDevice device, const VkBufferViewCreateInfo* info, const VkAllocationCallbacks* callbacks,
                VkBufferView* view),
               (device, info, callbacks, view))
VKOPPLE_FAULTY(vkCreateDescriptorPool,
               (VkDevice device, const VkDescriptorPoolCreateInfo* info, const VkAllocationCallbacks* callbacks,
                VkDescriptorPool* pool),
               (device, info, callbacks, pool))
VKOPPLE_FAULTY(vkCreateCommandPool,
               (VkDevice device, const VkCommandPoolCreateInfo* info, const VkAllocationCallbacks* callbacks,
                VkCommandPool* pool),
               (device, info, callbacks, pool))
VKOPPLE_FAULTY(vkAllocateCommandBuffers,
               (VkDevice device, const VkCommandBufferAllocateInfo* info, VkCommandBuffer* buffers),
               (device, info, buffers))
VKOPPLE_FAULTY(vkCreateFence,
               (VkDevice device, const VkFenceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                VkFence* fence),
               (device, info, callbacks, fence))
VKOPPLE_FAULTY(vkQueueSubmit, (VkQueue queue, uint32_t count, const VkSubmitInfo* infos, VkFence fence),
               (queue, count, infos, fence))

/// The work that is waited for ends before the fault is told: its memory is freed next, and the device is not
/// really lost.
extern "C" VKAPI_ATTR VkResult VKAPI_CALL vkWaitForFences(VkDevice device, uint32_t count,
                                                          const VkFence* fences, VkBool32 all,
                                                          uint64_t timeout) {
  static const auto loader = real(&vkWaitForFences, "vkWaitForFences");
  const VkResult fault = VulkanFaults::next("vkWaitForFences");
  const VkResult result = loader(device, count, fences, all, timeout);
  if (fault == VK_SUCCESS) return result;
  vkResetFences(device, count, fences);
  return fault;
}
