#pragma once

#include <array>
#include <span>
#include <vector>

#include "runtime/caps.h"
#include "runtime/vulkan_cooperative_matrix.h"

namespace vkopple {

/// Everything beyond Vulkan 1.1 that shaders with cooperative matrices use: the matrices, float16 as their
/// elements, Vulkan's memory model, which the front end demands, and workgroups whose subgroups are full.
class CooperativeFeatures {
 public:
  static constexpr std::array kExtensions{
      VK_KHR_COOPERATIVE_MATRIX_EXTENSION_NAME, VK_KHR_SHADER_FLOAT16_INT8_EXTENSION_NAME,
      VK_KHR_VULKAN_MEMORY_MODEL_EXTENSION_NAME, VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME};

  /// All of them off. For a query, or after enable() for creating a device that has them.
  CooperativeFeatures();
  CooperativeFeatures(const CooperativeFeatures&) = delete;
  CooperativeFeatures& operator=(const CooperativeFeatures&) = delete;

  void* chain() { return &matrix_; }
  bool all() const;
  void enable();

 private:
  VkPhysicalDeviceCooperativeMatrixFeaturesKHR matrix_{};
  VkPhysicalDeviceShaderFloat16Int8Features float16_{};
  VkPhysicalDeviceVulkanMemoryModelFeatures memory_model_{};
  VkPhysicalDeviceSubgroupSizeControlFeatures subgroups_{};
};

/// Of what a device offers, the shapes that kernels take: float16 times float16, added in float32 by a
/// subgroup, sizes powers of 2 from 8 on, so that rows and columns are whole vectors of 16 bytes.
std::vector<MatrixShape> suitable_shapes(std::span<const VkCooperativeMatrixPropertiesKHR> offered);

/// The suitable shapes of a device that lists CooperativeFeatures::kExtensions; empty where it lacks a feature.
std::vector<MatrixShape> query_cooperative_matrices(VkInstance instance, VkPhysicalDevice device);

}  // namespace vkopple
