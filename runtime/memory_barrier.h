#pragma once

#include <vulkan/vulkan.h>

namespace vkopple {

/// What follows in the command buffer waits for all dispatches, fills and copies before it and sees their
/// bytes.
void order_work(VkCommandBuffer commands);
/// The same, with whatever was submitted before (another chunk, another program) and the host's writes.
void wait_for_all_before(VkCommandBuffer commands);
/// The host sees what was written, once it has waited for the commands' end.
void show_to_host(VkCommandBuffer commands);

}  // namespace vkopple
