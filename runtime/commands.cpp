#include "runtime/bounds.h"
#include "runtime/device.h"
#include "runtime/recorder.h"
#include "runtime/vulkan_error.h"

namespace vkopple {

Commands::Commands(const Device& device) : device_(&device) {
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.queueFamilyIndex = device.queue_family();
  check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), "vkCreateCommandPool");
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  const VkResult made = vkCreateFence(device.handle(), &fence, nullptr, &fence_);
  if (made != VK_SUCCESS) vkDestroyCommandPool(device.handle(), pool_, nullptr);
  check(made, "vkCreateFence");
}

Commands::~Commands() {
  const VkDevice device = device_->handle();
  for (VkDescriptorPool pool : descriptor_pools_) vkDestroyDescriptorPool(device, pool, nullptr);
  if (queries_ != VK_NULL_HANDLE) vkDestroyQueryPool(device, queries_, nullptr);
  if (fence_ != VK_NULL_HANDLE) vkDestroyFence(device, fence_, nullptr);
  if (pool_ != VK_NULL_HANDLE) vkDestroyCommandPool(device, pool_, nullptr);
}

Slice Commands::absent(bool writes) {
  constexpr uint64_t kAbsentWithBands = kAbsentBytes + 2 * kGuardBytes;
  if (!absent_)
    absent_ = std::make_unique<Buffer>(*device_, 2 * kAbsentWithBands, MemoryKind::kDevice, "absent operand");
  return absent_->whole().sub((writes ? kAbsentWithBands : 0) + kGuardBytes, kAbsentBytes);
}

void Commands::submit(VkCommandBuffer buffer, VkFence fence) const {
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &buffer;
  check(vkQueueSubmit(device_->queue(), 1, &submit, fence), "vkQueueSubmit");
}

void Commands::wait() const {
  check(vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  check(vkResetFences(device_->handle(), 1, &fence_), "vkResetFences");
}

RunTimes Commands::run() const {
  try {
    return submit_all();
  } catch (...) {
    // What was submitted before may be under way, and who catches this may free what it uses.
    vkQueueWaitIdle(device_->queue());
    throw;
  }
}

RunTimes Commands::submit_all() const {
  RunTimes times;
  times.begin = std::chrono::steady_clock::now();
  auto step = host_steps_.begin();
  for (size_t i = 0; i < buffers_.size(); ++i) {
    const bool last = i + 1 == buffers_.size();
    const bool stops = step != host_steps_.end() && step->chunks == i + 1;
    submit(buffers_[i], last || stops ? fence_ : VK_NULL_HANDLE);
    if (!stops) continue;
    wait();
    step->run();
    ++step;
  }
  times.submitted = std::chrono::steady_clock::now();
  wait();
  times.end = std::chrono::steady_clock::now();
  return times;
}

std::vector<CommandTime> Commands::command_times() const {
  if (timed_.empty()) return {};
  std::vector<uint64_t> ticks(stamps_);
  check(
      vkGetQueryPoolResults(device_->handle(), queries_, 0, stamps_, ticks.size() * sizeof(uint64_t),
                            ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
      "vkGetQueryPoolResults");
  const double period = static_cast<double>(device_->caps().timestamp_period) * 1e-9;
  const auto seconds = [&](uint32_t stamp) { return static_cast<double>(ticks[stamp] - ticks[0]) * period; };
  std::vector<CommandTime> times;
  times.reserve(timed_.size());
  for (const Timed& t : timed_) times.push_back({t.name, t.section, seconds(t.begin), seconds(t.end)});
  return times;
}

}  // namespace vkopple
