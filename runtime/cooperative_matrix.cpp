#include "runtime/cooperative_matrix.h"

#include <bit>

#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

bool is_size(uint32_t size) { return std::has_single_bit(size) && size >= 8; }

bool suits(const VkCooperativeMatrixPropertiesKHR& p) {
  return p.AType == VK_COMPONENT_TYPE_FLOAT16_KHR && p.BType == VK_COMPONENT_TYPE_FLOAT16_KHR &&
         p.CType == VK_COMPONENT_TYPE_FLOAT32_KHR && p.ResultType == VK_COMPONENT_TYPE_FLOAT32_KHR &&
         p.saturatingAccumulation == VK_FALSE && p.scope == VK_SCOPE_SUBGROUP_KHR && is_size(p.MSize) &&
         is_size(p.NSize) && is_size(p.KSize);
}

}  // namespace

CooperativeFeatures::CooperativeFeatures() {
  matrix_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_COOPERATIVE_MATRIX_FEATURES_KHR;
  matrix_.pNext = &float16_;
  float16_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES;
  float16_.pNext = &memory_model_;
  memory_model_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_MEMORY_MODEL_FEATURES;
  memory_model_.pNext = &subgroups_;
  subgroups_.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES;
}

bool CooperativeFeatures::all() const {
  return matrix_.cooperativeMatrix != VK_FALSE && float16_.shaderFloat16 != VK_FALSE &&
         memory_model_.vulkanMemoryModel != VK_FALSE &&
         memory_model_.vulkanMemoryModelDeviceScope != VK_FALSE && subgroups_.computeFullSubgroups != VK_FALSE;
}

void CooperativeFeatures::enable() {
  matrix_.cooperativeMatrix = VK_TRUE;
  float16_.shaderFloat16 = VK_TRUE;
  memory_model_.vulkanMemoryModel = VK_TRUE;
  // With the model on, every shader's atomics need it, those of other memory models too.
  memory_model_.vulkanMemoryModelDeviceScope = VK_TRUE;
  subgroups_.computeFullSubgroups = VK_TRUE;
}

std::vector<MatrixShape> suitable_shapes(std::span<const VkCooperativeMatrixPropertiesKHR> offered) {
  std::vector<MatrixShape> shapes;
  for (const auto& p : offered)
    if (suits(p)) shapes.push_back({p.MSize, p.NSize, p.KSize});
  return shapes;
}

std::vector<MatrixShape> query_cooperative_matrices(VkInstance instance, VkPhysicalDevice device) {
  constexpr const char* kCall = "vkGetPhysicalDeviceCooperativeMatrixPropertiesKHR";
  CooperativeFeatures features;
  VkPhysicalDeviceFeatures2 all{};
  all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  all.pNext = features.chain();
  vkGetPhysicalDeviceFeatures2(device, &all);
  const auto get = reinterpret_cast<PFN_vkGetPhysicalDeviceCooperativeMatrixPropertiesKHR>(
      vkGetInstanceProcAddr(instance, kCall));
  if (!features.all() || get == nullptr) return {};
  uint32_t count = 0;
  check(get(device, &count, nullptr), kCall);
  VkCooperativeMatrixPropertiesKHR empty{};
  empty.sType = VK_STRUCTURE_TYPE_COOPERATIVE_MATRIX_PROPERTIES_KHR;
  std::vector<VkCooperativeMatrixPropertiesKHR> offered(count, empty);
  check(get(device, &count, offered.data()), kCall);
  offered.resize(count);
  return suitable_shapes(offered);
}

}  // namespace vkopple
