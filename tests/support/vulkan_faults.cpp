#include "tests/support/vulkan_faults.h"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "tests/support/vulkan_objects.h"

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

using vkopple::test::note_gone;
using vkopple::test::note_made;
using vkopple::test::real;
using vkopple::test::vulkan_object;
using vkopple::test::VulkanFaults;

// Each in place of the loader's function of that name. `made` is done where it succeeds. Not all of them fail.
#define VKOPPLE_STANDS_IN(name, fault_of, parameters, arguments, made) \
  extern "C" VKAPI_ATTR VkResult VKAPI_CALL name parameters {          \
    static const auto loader = real(&name, #name);                     \
    const VkResult fault = fault_of(#name);                            \
    if (fault != VK_SUCCESS) return fault;                             \
    const VkResult result = loader arguments;                          \
    if (result == VK_SUCCESS) {                                        \
      made;                                                            \
    }                                                                  \
    return result;                                                     \
  }

#define VKOPPLE_FAULTY VulkanFaults::next
#define VKOPPLE_SOUND [](const char*) { return VK_SUCCESS; }

#define VKOPPLE_CREATES(name, fault_of, Info, Handle, kind, bytes)                                            \
  VKOPPLE_STANDS_IN(name, fault_of,                                                                           \
                    (VkDevice device, const Info* info, const VkAllocationCallbacks* callbacks, Handle* one), \
                    (device, info, callbacks, one), note_made(vulkan_object(kind, *one), {}, bytes))

#define VKOPPLE_DESTROYS(name, Handle, kind)                                           \
  extern "C" VKAPI_ATTR void VKAPI_CALL name(VkDevice device, Handle one,              \
                                             const VkAllocationCallbacks* callbacks) { \
    static const auto loader = real(&name, #name);                                     \
    note_gone(vulkan_object(kind, one));                                               \
    loader(device, one, callbacks);                                                    \
  }

VKOPPLE_CREATES(vkAllocateMemory, VKOPPLE_FAULTY, VkMemoryAllocateInfo, VkDeviceMemory, "allocations",
                info->allocationSize)
VKOPPLE_DESTROYS(vkFreeMemory, VkDeviceMemory, "allocations")
VKOPPLE_CREATES(vkCreateBuffer, VKOPPLE_FAULTY, VkBufferCreateInfo, VkBuffer, "buffers", 0)
VKOPPLE_DESTROYS(vkDestroyBuffer, VkBuffer, "buffers")
VKOPPLE_CREATES(vkCreateBufferView, VKOPPLE_FAULTY, VkBufferViewCreateInfo, VkBufferView, "buffer views", 0)
VKOPPLE_DESTROYS(vkDestroyBufferView, VkBufferView, "buffer views")
VKOPPLE_CREATES(vkCreateDescriptorPool, VKOPPLE_FAULTY, VkDescriptorPoolCreateInfo, VkDescriptorPool,
                "descriptor pools", 0)
VKOPPLE_DESTROYS(vkDestroyDescriptorPool, VkDescriptorPool, "descriptor pools")
VKOPPLE_CREATES(vkCreateDescriptorSetLayout, VKOPPLE_SOUND, VkDescriptorSetLayoutCreateInfo,
                VkDescriptorSetLayout, "descriptor set layouts", 0)
VKOPPLE_DESTROYS(vkDestroyDescriptorSetLayout, VkDescriptorSetLayout, "descriptor set layouts")
VKOPPLE_CREATES(vkCreateCommandPool, VKOPPLE_FAULTY, VkCommandPoolCreateInfo, VkCommandPool, "command pools", 0)
VKOPPLE_DESTROYS(vkDestroyCommandPool, VkCommandPool, "command pools")
VKOPPLE_CREATES(vkCreateFence, VKOPPLE_FAULTY, VkFenceCreateInfo, VkFence, "fences", 0)
VKOPPLE_DESTROYS(vkDestroyFence, VkFence, "fences")
VKOPPLE_CREATES(vkCreateQueryPool, VKOPPLE_SOUND, VkQueryPoolCreateInfo, VkQueryPool, "query pools", 0)
VKOPPLE_DESTROYS(vkDestroyQueryPool, VkQueryPool, "query pools")
VKOPPLE_CREATES(vkCreateShaderModule, VKOPPLE_SOUND, VkShaderModuleCreateInfo, VkShaderModule, "shader modules",
                0)
VKOPPLE_DESTROYS(vkDestroyShaderModule, VkShaderModule, "shader modules")
VKOPPLE_CREATES(vkCreatePipelineLayout, VKOPPLE_SOUND, VkPipelineLayoutCreateInfo, VkPipelineLayout,
                "pipeline layouts", 0)
VKOPPLE_DESTROYS(vkDestroyPipelineLayout, VkPipelineLayout, "pipeline layouts")
VKOPPLE_STANDS_IN(vkCreateComputePipelines, VKOPPLE_SOUND,
                  (VkDevice device, VkPipelineCache cache, uint32_t count,
                   const VkComputePipelineCreateInfo* infos, const VkAllocationCallbacks* callbacks,
                   VkPipeline* pipelines),
                  (device, cache, count, infos, callbacks, pipelines),
                  for (uint32_t i = 0; i < count; ++i) note_made(vulkan_object("pipelines", pipelines[i])))
VKOPPLE_DESTROYS(vkDestroyPipeline, VkPipeline, "pipelines")

// What a pool hands out ends with it: nothing is freed one by one.
VKOPPLE_STANDS_IN(vkAllocateCommandBuffers, VKOPPLE_FAULTY,
                  (VkDevice device, const VkCommandBufferAllocateInfo* info, VkCommandBuffer* buffers),
                  (device, info, buffers),
                  for (uint32_t i = 0; i < info->commandBufferCount; ++i)
                      note_made(vulkan_object("command buffers", buffers[i]),
                                vulkan_object("command pools", info->commandPool)))
VKOPPLE_STANDS_IN(vkAllocateDescriptorSets, VKOPPLE_SOUND,
                  (VkDevice device, const VkDescriptorSetAllocateInfo* info, VkDescriptorSet* sets),
                  (device, info, sets),
                  for (uint32_t i = 0; i < info->descriptorSetCount; ++i)
                      note_made(vulkan_object("descriptor sets", sets[i]),
                                vulkan_object("descriptor pools", info->descriptorPool)))

VKOPPLE_STANDS_IN(vkBindBufferMemory, VKOPPLE_FAULTY,
                  (VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset),
                  (device, buffer, memory, offset), )
VKOPPLE_STANDS_IN(vkMapMemory, VKOPPLE_FAULTY,
                  (VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
                   VkMemoryMapFlags flags, void** data),
                  (device, memory, offset, size, flags, data), )
VKOPPLE_STANDS_IN(vkQueueSubmit, VKOPPLE_FAULTY,
                  (VkQueue queue, uint32_t count, const VkSubmitInfo* infos, VkFence fence),
                  (queue, count, infos, fence), )

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
