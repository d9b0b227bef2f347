#pragma once

#include <vulkan/vulkan.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/device_choice.h"

namespace vkopple {

/// Receives every warning and error of the validation layer.
using MessageSink = std::function<void(const std::string&)>;

/// A Vulkan instance, with the validation layer (synchronization validation included) where a sink is given.
class Instance {
 public:
  /// Throws Error where there is no Vulkan, or where the layer is asked for and not installed.
  explicit Instance(MessageSink sink = {});
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return instance_; }
  bool validates() const { return messenger_ != VK_NULL_HANDLE; }
  std::vector<VkPhysicalDevice> physical_devices() const;
  std::vector<Candidate> candidates() const;

 private:
  void create_messenger();

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::unique_ptr<MessageSink> sink_;
};

/// What `device`, one of the instance's, can do and what it lacks.
Candidate inspect(VkInstance instance, VkPhysicalDevice device);

}  // namespace vkopple
