#include "runtime/memory_barrier.h"

namespace vkopple {
namespace {

constexpr VkPipelineStageFlags kWork = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
constexpr VkAccessFlags kWritten = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags kUsed = kWritten | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;

void memory_barrier(VkCommandBuffer buffer, VkPipelineStageFlags from, VkAccessFlags written,
                    VkPipelineStageFlags to, VkAccessFlags used) {
  VkMemoryBarrier barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = written;
  barrier.dstAccessMask = used;
  vkCmdPipelineBarrier(buffer, from, to, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

}  // namespace

void order_work(VkCommandBuffer commands) { memory_barrier(commands, kWork, kWritten, kWork, kUsed); }

void wait_for_all_before(VkCommandBuffer commands) {
  memory_barrier(commands, kWork | VK_PIPELINE_STAGE_HOST_BIT, kWritten | VK_ACCESS_HOST_WRITE_BIT, kWork,
                 kUsed);
}

void show_to_host(VkCommandBuffer commands) {
  memory_barrier(commands, kWork, kWritten, VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

}  // namespace vkopple
