#include "runtime/pipeline.h"

#include <fmt/format.h>

#include "runtime/device.h"
#include "runtime/guarded_shader.h"
#include "runtime/pipeline_cache.h"
#include "runtime/quirks.h"
#include "runtime/requirements.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

/// Specialization constants that access.glsl, subgroup.glsl, row_store.glsl and product_remainder.glsl may use
/// in any shader.
constexpr uint32_t kZeroOutsideId = 100;
constexpr uint32_t kSubgroupSizeId = 101;
constexpr uint32_t kFloat16BindingsId = 102;
constexpr uint32_t kRowStoresId = 103;
constexpr uint32_t kFusedProductsId = 104;

VkDescriptorType descriptor_type(BindingKind kind, AccessPath access) {
  return is_texel(kind, access) ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

}  // namespace

PipelineSet::PipelineSet(const Device& device, const std::filesystem::path& cache_folder) : device_(&device) {
  std::vector<std::byte> data;
  if (!cache_folder.empty()) {
    cache_file_ = cache_folder / pipeline_cache_name(device.caps());
    data = load_pipeline_cache(cache_file_, device.caps());
  }
  VkPipelineCacheCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  check(vkCreatePipelineCache(device.handle(), &info, nullptr, &cache_), "vkCreatePipelineCache");
  loaded_bytes_ = data.size();
}

PipelineSet::~PipelineSet() {
  const VkDevice device = device_->handle();
  size_t bytes = 0;
  if (!cache_file_.empty() && !pipelines_.empty() &&
      vkGetPipelineCacheData(device, cache_, &bytes, nullptr) == VK_SUCCESS && bytes > loaded_bytes_) {
    std::vector<std::byte> data(bytes);
    if (vkGetPipelineCacheData(device, cache_, &bytes, data.data()) == VK_SUCCESS)
      save_pipeline_cache(cache_file_, device_->caps(), std::span(data).first(bytes));
  }
  for (const auto& [key, p] : pipelines_) {
    vkDestroyPipeline(device, p.pipeline, nullptr);
    vkDestroyPipelineLayout(device, p.layout, nullptr);
    vkDestroyDescriptorSetLayout(device, p.set_layout, nullptr);
  }
  vkDestroyPipelineCache(device, cache_, nullptr);
}

const Pipeline& PipelineSet::get(std::string_view shader, const std::vector<uint32_t>& constants,
                                 uint32_t float16_bindings, Bounds bounds) {
  const auto [entry, added] =
      pipelines_.try_emplace(Key{std::string(shader), constants, float16_bindings, bounds});
  if (added) {
    try {
      entry->second.shader = &find_shader(shader, device_->caps().access);
      entry->second.bindings = binding_kinds(*entry->second.shader);
      create(entry->second, entry->first);
    } catch (...) {
      pipelines_.erase(entry);
      throw;
    }
  }
  return entry->second;
}

void PipelineSet::create_layouts(Pipeline& pipeline) const {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (BindingKind kind : pipeline.bindings) {
    VkDescriptorSetLayoutBinding binding{};
    binding.binding = static_cast<uint32_t>(bindings.size());
    binding.descriptorType = descriptor_type(kind, pipeline.shader->access);
    binding.descriptorCount = 1;
    binding.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    bindings.push_back(binding);
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = static_cast<uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(device_->handle(), &set, nullptr, &pipeline.set_layout),
        "vkCreateDescriptorSetLayout");
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, kPushConstantBytes};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &pipeline.set_layout;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &push;
  check(vkCreatePipelineLayout(device_->handle(), &layout, nullptr, &pipeline.layout),
        "vkCreatePipelineLayout");
}

void PipelineSet::create(Pipeline& pipeline, const Key& key) {
  create_layouts(pipeline);
  std::vector<uint32_t> values;
  std::vector<VkSpecializationMapEntry> entries;
  const auto set = [&](uint32_t id, uint32_t value) {
    entries.push_back({id, static_cast<uint32_t>(values.size() * 4), 4});
    values.push_back(value);
  };
  for (uint32_t id = 0; id < key.constants.size(); ++id) set(id, key.constants[id]);
  set(kZeroOutsideId, device_->caps().lavapipe ? 1 : 0);
  set(kSubgroupSizeId, device_->caps().subgroup_size);
  set(kFloat16BindingsId, key.float16_bindings);
  set(kRowStoresId, device_->caps().row_stores ? 1 : 0);
  set(kFusedProductsId, fuses_products(device_->caps()) ? 1 : 0);
  VkSpecializationInfo specialization{};
  specialization.mapEntryCount = static_cast<uint32_t>(entries.size());
  specialization.pMapEntries = entries.data();
  specialization.dataSize = values.size() * 4;
  specialization.pData = values.data();

  std::vector<uint32_t> guarded;
  if (key.bounds == Bounds::kGuarded) guarded = guarded_code(*pipeline.shader);
  const std::span<const uint32_t> code = guarded.empty() ? pipeline.shader->code : guarded;
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module_info.codeSize = code.size_bytes();
  module_info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device_->handle(), &module_info, nullptr, &module), "vkCreateShaderModule");
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  // A cooperative matrix is spread over all of a subgroup's lanes.
  if (uses_cooperative_matrices(*pipeline.shader))
    info.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
  info.layout = pipeline.layout;
  const VkResult result =
      vkCreateComputePipelines(device_->handle(), cache_, 1, &info, nullptr, &pipeline.pipeline);
  vkDestroyShaderModule(device_->handle(), module, nullptr);
  check(result, fmt::format("vkCreateComputePipelines of {}", pipeline.shader->name));
}

}  // namespace vkopple
