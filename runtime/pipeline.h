#pragma once

#include <vulkan/vulkan.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/bounds.h"
#include "runtime/shader_library.h"

namespace vkopple {

class Device;

/// A compute pipeline with its layouts. Bindings are numbered as in the shader; 128 bytes of push constants.
struct Pipeline {
  const ShaderCode* shader = nullptr;
  std::vector<BindingKind> bindings;  ///< by number
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkPipeline pipeline = VK_NULL_HANDLE;
};

/// Makes pipelines from shader names and specialization constants, each once, with a cache on disk.
class PipelineSet {
 public:
  /// cache_folder: where the cache file lies; empty for none. A damaged or foreign file is ignored with a
  /// warning.
  PipelineSet(const Device& device, const std::filesystem::path& cache_folder);
  /// Writes the cache where it grew.
  ~PipelineSet();
  PipelineSet(const PipelineSet&) = delete;
  PipelineSet& operator=(const PipelineSet&) = delete;

  /// constants[i] sets constant_id i; id 0 is the workgroup's size in x. The device's facts (access.glsl, ids
  /// from 100) are added. float16_bindings: bit b where binding b holds float16. Throws Error for an unknown
  /// shader.
  const Pipeline& get(std::string_view shader, const std::vector<uint32_t>& constants,
                      uint32_t float16_bindings = 0, Bounds bounds = Bounds::kExact);
  size_t size() const { return pipelines_.size(); }

 private:
  struct Key {
    std::string shader;
    std::vector<uint32_t> constants;
    uint32_t float16_bindings;
    Bounds bounds;
    auto operator<=>(const Key&) const = default;
  };
  void create(Pipeline& pipeline, const Key& key);
  void create_layouts(Pipeline& pipeline) const;

  const Device* device_;
  std::filesystem::path cache_file_;
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  size_t loaded_bytes_ = 0;
  std::map<Key, Pipeline> pipelines_;
};

}  // namespace vkopple
