#pragma once

#include <vulkan/vulkan.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "runtime/caps.h"
#include "runtime/instance.h"

namespace vkopple {

class PipelineSet;
class Staging;

struct DeviceOptions {
  std::string selector;              ///< as device_selector takes it
  MessageSink on_message;            ///< loads the validation layer and receives what it says
  std::optional<AccessPath> access;  ///< forces an access path (tests run both)
  std::optional<bool> row_stores;    ///< Caps::row_stores; none: where they are known to be faster
  bool long_work = false;            ///< Caps::long_work
  bool exact_sums = false;           ///< Caps::exact_sums
  /// Caps::winograd; Error where the device, or exact_sums, can't have what it says.
  WinogradUse winograd = WinogradUse::kWhereFaster;
  KernelFamily kernels = KernelFamily::kAuto;  ///< Caps::kernels; Error where the device can't run the family
  /// Choices measured on the device that was found, for Caps::tuned; empty: none.
  std::function<std::shared_ptr<const TunedChoices>(const Caps&)> tuned;
  std::filesystem::path cache_folder;  ///< of the pipeline cache; empty: default_cache_folder()
  bool use_cache = true;               ///< false: neither reads nor writes the pipeline cache
};

/// $XDG_CACHE_HOME/vkopple or ~/.cache/vkopple; empty when neither is known.
std::filesystem::path default_cache_folder();

/// A logical device with one compute queue and its pipelines. Outlives everything made from it.
class Device {
 public:
  /// Throws Error (no device, none usable), UsageError (the selector) or VulkanError.
  explicit Device(DeviceOptions options = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle() const { return device_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkQueue queue() const { return queue_; }
  uint32_t queue_family() const { return queue_family_; }
  const Caps& caps() const { return caps_; }
  PipelineSet& pipelines() const { return *pipelines_; }
  Staging& staging() const { return *staging_; }

  /// Gives a Vulkan object a name for debuggers and validation messages; nothing where the device can't.
  void set_name(VkObjectType type, uint64_t handle, const std::string& name) const;

 private:
  void create_logical_device();

  Instance instance_;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  uint32_t queue_family_ = 0;
  Caps caps_;
  PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
  std::unique_ptr<PipelineSet> pipelines_;
  std::unique_ptr<Staging> staging_;
};

}  // namespace vkopple
