#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "graph/ops/adam.h"
#include "graph/ops/loss_scale.h"
#include "models/config.h"
#include "models/opple.h"
#include "models/perception_graph.h"
#include "runtime/dispatch.h"
#include "runtime/error.h"
#include "runtime/requirements.h"
#include "tests/support/dry_run.h"
#include "tests/support/expect_error.h"
#include "tests/support/gpu_caps.h"
#include "tests/support/shader_needs.h"

namespace vkopple {
namespace {

constexpr uint64_t kLeastStorageRange = uint64_t{1} << 27;  // of Vulkan, as is what gpu_caps() has

/// No optional feature, and limits that every implementation of Vulkan has.
Caps least(DeviceType type, uint32_t subgroup) {
  Caps caps = test::gpu_caps(128, 16384, subgroup);
  caps.type = type;
  caps.max_storage_range = kLeastStorageRange;
  caps.max_texel_elements = 65536;
  caps.max_allocation_bytes = uint64_t{1} << 30;
  return caps;
}

/// What devices of today have, subgroups of any size.
Caps generous(DeviceType type, uint32_t subgroup) {
  Caps caps = least(type, subgroup);
  caps.max_workgroup_size = 1024;
  caps.shared_memory_bytes = 49152;
  caps.max_storage_range = ~uint32_t{0};
  caps.max_texel_elements = uint64_t{1} << 27;
  caps.max_groups = {0x7fffffff, 65535, 65535};
  caps.subgroup_shuffle = caps.subgroup_arithmetic = caps.int64 = true;
  return caps;
}

/// As Mesa's driver for CPUs, with subgroups of any size.
Caps texel_cpu(uint32_t subgroup) {
  Caps caps = generous(DeviceType::kCpu, subgroup);
  caps.max_groups = {65535, 65535, 65535};
  caps.max_storage_range = kLeastStorageRange;
  caps.lavapipe = true;
  caps.access = AccessPath::kTexel;
  caps.row_stores = subgroup >= 2 && subgroup <= 16;
  return caps;
}

Caps cooperative_gpu(uint32_t subgroup) {
  Caps caps = generous(DeviceType::kDiscrete, subgroup);
  caps.cooperative_matrices = {{16, 16, 16}, {16, 8, 16}, {16, 8, 8}};
  return caps;
}

/// Holds every dispatch against what a device has.
class LimitCheck {
 public:
  explicit LimitCheck(const Caps& caps) : caps_(caps) {}

  void operator()(const Node& node, const Dispatch& d) {
    ++dispatches_;
    const auto expect = [&](bool holds, const std::string& what) {
      if (!holds) found_.try_emplace(fmt::format("{}: {}", d.shader, what), node.scope);
    };
    const uint32_t local = d.constants.at(0);
    expect(local >= 1 && local <= caps_.max_workgroup_size, fmt::format("{} invocations", local));
    for (size_t i = 0; i < 3; ++i)
      expect(d.groups[i] <= caps_.max_groups[i], fmt::format("{} workgroups", d.groups[i]));
    expect(d.push_bytes <= kPushConstantBytes, fmt::format("{} bytes of push constants", d.push_bytes));
    const ShaderCode& shader = find_shader(d.shader, caps_.access);
    check_bindings(shader, d, expect);
    const test::ShaderNeeds& needs = needs_of(shader, d);
    expect(needs.shared_bytes <= caps_.shared_memory_bytes,
           fmt::format("{} bytes of shared memory", needs.shared_bytes));
    for (const uint32_t capability : needs.capabilities)
      expect(has(capability), fmt::format("capability {}", capability));
  }

  size_t dispatches() const { return dispatches_; }
  /// What the device has not: "conv_shared: 32768 bytes of shared memory", and where that was asked for first.
  const std::map<std::string, std::string>& found() const { return found_; }

 private:
  template <class Expect>
  void check_bindings(const ShaderCode& shader, const Dispatch& d, const Expect& expect) {
    auto& kinds = kinds_[shader.name];
    if (kinds.empty()) kinds = binding_kinds(shader);
    for (size_t i = 0; i < kinds.size(); ++i) {
      const Slice& slice = d.bindings[i];
      if (!slice) continue;
      expect(slice.offset % caps_.offset_alignment == 0, fmt::format("offset {} of {}", slice.offset, i));
      if (is_texel(kinds[i], caps_.access))
        expect(slice.bytes / texel_bytes(kinds[i], slice.storage) <= caps_.max_texel_elements,
               fmt::format("{} bytes of texel buffer {}", slice.bytes, i));
      else
        expect(slice.bytes <= caps_.max_storage_range, fmt::format("{} bytes of binding {}", slice.bytes, i));
    }
  }

  /// The numbers are SPIR-V's.
  bool has(uint32_t capability) const {
    switch (capability) {
      case 1:   // Shader
      case 46:  // SampledBuffer: of Vulkan 1.0
      case 61:  // GroupNonUniform: of Vulkan 1.1
        return true;
      case 11:  // Int64
        return caps_.int64;
      case 65:  // GroupNonUniformShuffle
        return caps_.subgroup_shuffle;
      case 9:     // Float16
      case 5345:  // VulkanMemoryModel
      case 6022:  // CooperativeMatrixKHR
        return !caps_.cooperative_matrices.empty();
      default:
        return false;
    }
  }

  const test::ShaderNeeds& needs_of(const ShaderCode& shader, const Dispatch& d) {
    // The ids from 100 on are those of runtime/pipeline.cpp.
    std::map<uint32_t, uint32_t> constants{
        {100, caps_.lavapipe ? 1 : 0}, {101, caps_.subgroup_size}, {103, caps_.row_stores ? 1 : 0}};
    for (uint32_t i = 0; i < d.constants.size(); ++i) constants[i] = d.constants[i];
    const auto [entry, added] = needs_.try_emplace({shader.name, d.constants});
    if (added) entry->second = test::shader_needs(shader, constants);
    return entry->second;
  }

  const Caps& caps_;
  size_t dispatches_ = 0;
  std::map<std::string, std::string> found_;
  std::map<std::string_view, std::vector<BindingKind>> kinds_;
  std::map<std::pair<std::string_view, std::vector<uint32_t>>, test::ShaderNeeds> needs_;
};

enum class Work { kAll, kBackground, kMixed, kPerception };

/// Everything that one command would run on a device.
struct Job {
  std::string preset;
  int64_t batch;
  Work work;

  std::string name() const {
    constexpr std::array names{"training", "background", "mixed training", "perception"};
    return fmt::format("{}, batch {}, {}", preset, batch, names[static_cast<size_t>(work)]);
  }
};

/// Has everything recorded for a device of such caps. Throws what refuses it.
void record(const Job& job, const Caps& caps, LimitCheck& check) {
  const Config config = Config::load(job.preset);
  Graph graph;
  if (job.work == Work::kPerception) {
    perception_graph(graph, config.model, job.batch, true, caps.max_tensor_bytes());
    return test::dry_run(graph, {}, {}, caps, std::ref(check));
  }
  const bool mixed = job.work == Work::kMixed;
  const Opple model(graph, config.model,
                    {.batch = job.batch,
                     .training = true,
                     .background_only = job.work == Work::kBackground,
                     .precision = mixed ? Precision::kMixed : Precision::kFloat32,
                     .max_tensor_bytes = caps.max_tensor_bytes()});
  const auto groups = model.groups();
  const Value scale = mixed ? loss_scale(graph, groups) : Value();
  const Value rate = learning_rate(graph);
  for (const std::string& group : groups) adam(graph, group, {}, rate, scale);
  test::dry_run(graph, model.loss(), groups, caps, std::ref(check));
}

void expect_all_fits(const Job& job, const Caps& caps) {
  SCOPED_TRACE(fmt::format("{}, subgroups of {}", job.name(), caps.subgroup_size));
  LimitCheck check(caps);
  try {
    record(job, caps, check);
  } catch (const Error& error) {
    ADD_FAILURE() << "refused: " << error.what();
  }
  for (const auto& [what, where] : check.found()) ADD_FAILURE() << where << ", " << what;
  EXPECT_GT(check.dispatches(), 50U);
}

std::vector<Job> jobs(std::initializer_list<int64_t> batches) {
  std::vector<Job> all;
  for (const char* preset : {"small", "full"})
    for (const int64_t batch : batches)
      for (const Work work : {Work::kAll, Work::kBackground, Work::kMixed, Work::kPerception})
        all.push_back({preset, batch, work});
  return all;
}

class SimulatedDevices : public testing::TestWithParam<uint32_t> {};

INSTANTIATE_TEST_SUITE_P(Subgroups, SimulatedDevices, testing::Values(1U, 2U, 4U, 8U, 16U, 32U, 64U, 128U));

TEST_P(SimulatedDevices, TheLeastGpuIsGivenNothingTooLarge) {
  for (const Job& job : jobs({1, 4, 20})) expect_all_fits(job, least(DeviceType::kDiscrete, GetParam()));
}

TEST_P(SimulatedDevices, NorIsTheLeastCpu) {
  for (const Job& job : jobs({1, 4, 20})) expect_all_fits(job, least(DeviceType::kCpu, GetParam()));
}

TEST_P(SimulatedDevices, NorAreGenerousOnes) {
  for (const Job& job : jobs({4})) {
    expect_all_fits(job, generous(DeviceType::kDiscrete, GetParam()));
    expect_all_fits(job, texel_cpu(GetParam()));
  }
}

TEST_P(SimulatedDevices, NorWithKernelsOfEachFamily) {
  for (const KernelFamily family : {KernelFamily::kShared, KernelFamily::kPlain}) {
    Caps caps = least(DeviceType::kIntegrated, GetParam());
    caps.kernels = family;
    expect_all_fits({"full", 4, Work::kAll}, caps);
  }
  Caps registers = texel_cpu(GetParam());
  registers.kernels = KernelFamily::kRegisters;
  if (missing_for(KernelFamily::kRegisters, registers).empty())
    expect_all_fits({"full", 4, Work::kAll}, registers);
  Caps cooperative = cooperative_gpu(GetParam());
  for (const KernelFamily family : {KernelFamily::kAuto, KernelFamily::kCooperative}) {
    cooperative.kernels = family;
    expect_all_fits({"full", 4, Work::kMixed}, cooperative);
  }
}

TEST(SimulatedDevice, WhatIsChosenForOneDeviceIsFoundTooLargeForAnother) {
  const Caps small = least(DeviceType::kDiscrete, 32);
  LimitCheck check(small);
  record({"full", 4, Work::kMixed}, cooperative_gpu(32), check);
  record({"full", 20, Work::kAll}, generous(DeviceType::kDiscrete, 32), check);
  std::string all;
  for (const auto& [what, where] : check.found()) all += what + "\n";
  for (const char* part : {"invocations", "bytes of shared memory", "capability 6022", "bytes of binding"})
    EXPECT_THAT(all, testing::HasSubstr(part));
}

TEST(SimulatedDevice, ABatchThatNoBindingHoldsIsRefused) {
  const Caps caps = least(DeviceType::kDiscrete, 32);
  LimitCheck check(caps);
  test::expect_error(
      [&] {
        record({"full", 400, Work::kAll}, caps, check);
      },
      {"binds at most 128", "use a smaller --batch"});
}

TEST(Requirements, NoShaderBindsMore) {
  for (const ShaderCode& shader : shader_library())
    EXPECT_LE(binding_kinds(shader).size(), kMostBindings) << shader.name;
}

}  // namespace
}  // namespace vkopple
