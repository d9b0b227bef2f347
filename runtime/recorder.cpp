#include "runtime/recorder.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/device.h"
#include "runtime/memory_barrier.h"
#include "runtime/pipeline.h"
#include "runtime/vulkan_error.h"

namespace vkopple {
namespace {

constexpr uint32_t kSetsPerPool = 256;
constexpr uint32_t kDescriptorsPerSet = 8;
constexpr uint32_t kMostStamps = 65536;
/// A chunk of this size takes a slow integrated GPU well under a second; watchdogs wait for two or more.
constexpr double kChunkFlop = 40e9;
constexpr size_t kChunkDispatches = 512;
/// The last push constants: what shaders/include/row_store.glsl looks digits up in.
constexpr std::array<uint32_t, 8> kRowDigits{0, 1, 2, 3, 4, 5, 6, 7};
constexpr uint32_t kRowDigitsAt = 96;
/// Of shaders/include/unit_rows.glsl.
constexpr uint32_t kUnitRowsId = 4;

VkFormat texel_format(bool wide, Storage storage) {
  if (!wide) return VK_FORMAT_R32_SFLOAT;
  return storage == Storage::kFloat16 ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
}

/// Bit b: binding b holds float16.
uint32_t float16_mask(std::span<const Slice> bindings) {
  uint32_t mask = 0;
  for (size_t i = 0; i < bindings.size(); ++i)
    if (bindings[i].storage == Storage::kFloat16) mask |= 1U << i;
  return mask;
}

}  // namespace

Recorder::Recorder(const Device& device, bool timestamps)
    : device_(&device),
      timestamps_(timestamps && device.caps().timestamp_period > 0),
      commands_(std::make_unique<Commands>(device)) {
  if (timestamps_) {
    VkQueryPoolCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = kMostStamps;
    check(vkCreateQueryPool(device.handle(), &info, nullptr, &commands_->queries_), "vkCreateQueryPool");
  }
  begin_buffer();
}

Recorder::~Recorder() = default;

const Caps& Recorder::caps() const { return device_->caps(); }

void Recorder::begin_buffer() {
  VkCommandBufferAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = commands_->pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device_->handle(), &allocate, &buffer_), "vkAllocateCommandBuffers");
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  check(vkBeginCommandBuffer(buffer_, &begin), "vkBeginCommandBuffer");
  if (timestamps_ && commands_->buffers_.empty())
    vkCmdResetQueryPool(buffer_, commands_->queries_, 0, kMostStamps);
  wait_for_all_before(buffer_);
  pending_reads_.clear();
  pending_writes_.clear();
  chunk_dispatches_ = 0;
  chunk_flop_ = 0;
  if (timestamps_) stamp();
}

void Recorder::stamp() {
  if (commands_->stamps_ == kMostStamps)
    throw Error(fmt::format("a recording with timestamps holds at most {} commands; profile a smaller model",
                            kMostStamps));
  vkCmdWriteTimestamp(buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, commands_->queries_, commands_->stamps_);
  ++commands_->stamps_;
}

void Recorder::recorded(std::string_view name) {
  if (!timestamps_) return;
  stamp();
  commands_->timed_.push_back({std::string(name), section_, commands_->stamps_ - 2, commands_->stamps_ - 1});
}

void Recorder::end_buffer() {
  show_to_host(buffer_);
  check(vkEndCommandBuffer(buffer_), "vkEndCommandBuffer");
  commands_->buffers_.push_back(buffer_);
  buffer_ = VK_NULL_HANDLE;
}

void Recorder::order(std::span<const Slice> reads, std::span<const Slice> writes) {
  const auto meets = [](std::span<const Slice> a, std::span<const Slice> b) {
    return std::any_of(a.begin(), a.end(), [&](const Slice& x) {
      return std::any_of(b.begin(), b.end(), [&](const Slice& y) { return x.overlaps(y); });
    });
  };
  if (meets(writes, pending_writes_) || meets(writes, pending_reads_) || meets(reads, pending_writes_)) {
    order_work(buffer_);
    ++commands_->barriers_;
    pending_reads_.clear();
    pending_writes_.clear();
  }
  pending_reads_.insert(pending_reads_.end(), reads.begin(), reads.end());
  pending_writes_.insert(pending_writes_.end(), writes.begin(), writes.end());
}

VkDescriptorSet Recorder::allocate_set(const Pipeline& pipeline) {
  if (sets_left_ == 0) {
    const std::array<VkDescriptorPoolSize, 2> sizes{
        {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsPerPool * kDescriptorsPerSet},
         {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kSetsPerPool * kDescriptorsPerSet}}};
    VkDescriptorPoolCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.maxSets = kSetsPerPool;
    info.poolSizeCount = static_cast<uint32_t>(sizes.size());
    info.pPoolSizes = sizes.data();
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device_->handle(), &info, nullptr, &pool), "vkCreateDescriptorPool");
    commands_->descriptor_pools_.push_back(pool);
    sets_left_ = kSetsPerPool;
  }
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = commands_->descriptor_pools_.back();
  info.descriptorSetCount = 1;
  info.pSetLayouts = &pipeline.set_layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  const VkResult result = vkAllocateDescriptorSets(device_->handle(), &info, &set);
  if (result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTED_POOL) {
    // Shaders with many bindings use a pool up before its sets are.
    sets_left_ = 0;
    return allocate_set(pipeline);
  }
  check(result, "vkAllocateDescriptorSets");
  --sets_left_;
  return set;
}

VkDescriptorSet Recorder::make_set(const Pipeline& pipeline, std::span<const Slice> bindings) {
  const VkDescriptorSet set = allocate_set(pipeline);
  const auto& kinds = pipeline.bindings;
  std::vector<VkDescriptorBufferInfo> buffers(bindings.size());
  std::vector<VkBufferView> views(bindings.size());
  std::vector<VkWriteDescriptorSet> sets(bindings.size());
  for (uint32_t i = 0; i < bindings.size(); ++i) {
    const Slice slice = bindings[i] ? bindings[i] : commands_->absent(writes(kinds[i]));
    auto& write = sets[i];
    write = {};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set;
    write.dstBinding = i;
    write.descriptorCount = 1;
    const bool reads = kinds[i] == BindingKind::kRead4 || kinds[i] == BindingKind::kRead1;
    if (reads && pipeline.shader->access == AccessPath::kTexel) {
      const bool wide = kinds[i] == BindingKind::kRead4;
      write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
      const uint64_t element = element_bytes(slice.storage) * (wide ? 4 : 1);
      views[i] =
          slice.buffer->view(texel_format(wide, slice.storage), slice.offset, slice.bytes / element * element);
      write.pTexelBufferView = &views[i];
    } else {
      write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      buffers[i] = {slice.buffer->handle(), slice.offset, slice.bytes};
      write.pBufferInfo = &buffers[i];
    }
  }
  vkUpdateDescriptorSets(device_->handle(), static_cast<uint32_t>(sets.size()), sets.data(), 0, nullptr);
  return set;
}

void Recorder::dispatch(std::string_view shader, const std::vector<uint32_t>& constants,
                        std::span<const Slice> bindings, const Push& push, Groups groups) {
  const Pipeline& pipeline = device_->pipelines().get(shader, constants, float16_mask(bindings));
  const auto& kinds = pipeline.bindings;
  if (bindings.size() != kinds.size())
    throw Error(fmt::format("shader {} has {} bindings, {} were given", shader, kinds.size(), bindings.size()));
  for (size_t i = 0; i < 3; ++i) {
    if (groups[i] == 0) return;
    if (groups[i] > caps().max_groups[i])
      throw Error(
          fmt::format("shader {} needs {} workgroups in one direction, {} allows {}; use a smaller --batch "
                      "or image size",
                      shader, groups[i], caps().name, caps().max_groups[i]));
  }
  std::vector<Slice> reads;
  std::vector<Slice> written;
  for (size_t i = 0; i < bindings.size(); ++i) {
    if (!bindings[i]) {
      // Two kernels that may write the absent operand are ordered like any others.
      if (writes(kinds[i])) written.push_back(commands_->absent(true));
      continue;
    }
    if (bindings[i].bytes > caps().max_tensor_bytes())
      throw Error(
          fmt::format("shader {}: operand {} has {} MiB, {} binds at most {}; use a smaller --batch or "
                      "image size",
                      shader, i, bindings[i].bytes >> 20, caps().name, caps().max_tensor_bytes() >> 20));
    if (bindings[i].storage == Storage::kFloat16 && !takes_float16(kinds[i]))
      throw Error(fmt::format(
          "shader {}: operand {} is float16, which is read and written by vectors of four channels only",
          shader, i));
    (writes(kinds[i]) ? written : reads).push_back(bindings[i]);
  }
  order(reads, written);
  const VkDescriptorSet set = make_set(pipeline, bindings);
  vkCmdBindPipeline(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.pipeline);
  vkCmdBindDescriptorSets(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout, 0, 1, &set, 0, nullptr);
  if (push.bytes() > 0)
    vkCmdPushConstants(buffer_, pipeline.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, push.bytes(), push.data());
  if (caps().row_stores && push.bytes() <= kRowDigitsAt)
    vkCmdPushConstants(buffer_, pipeline.layout, VK_SHADER_STAGE_COMPUTE_BIT, kRowDigitsAt, sizeof(kRowDigits),
                       kRowDigits.data());
  vkCmdDispatch(buffer_, groups[0], groups[1], groups[2]);
  ++commands_->dispatches_;
  ++chunk_dispatches_;
  recorded(shader);
}

void Recorder::dispatch_flat(std::string_view shader, uint64_t count, std::initializer_list<Slice> bindings,
                             const Push& push, const std::vector<uint32_t>& constants) {
  const uint32_t local = caps().flat_workgroup();
  std::vector<uint32_t> all{local};
  all.insert(all.end(), constants.begin(), constants.end());
  const uint64_t groups = (count + local - 1) / local;
  const uint64_t columns = std::min<uint64_t>(groups, caps().max_groups[0]);
  const uint64_t rows = columns == 0 ? 0 : (groups + columns - 1) / columns;
  dispatch(shader, all, std::span(bindings.begin(), bindings.size()), push,
           {static_cast<uint32_t>(columns), static_cast<uint32_t>(rows), 1});
}

uint32_t Recorder::rows_of_group(uint64_t units, const UnitRows& may) const {
  // A workgroup costs as much as nine rows, and 32 rows a quarter of a second to compile. Enough workgroups
  // to share among threads are worth more.
  constexpr uint64_t kFewRows = 8, kManyRows = 32, kEnoughGroups = 64;
  if (!may.allowed || !caps().row_stores || units % 2 != 0) return 0;
  const auto suits = [&](uint64_t rows, uint64_t groups) {
    const uint64_t group = rows * caps().subgroup_size;
    return units >= groups * group && (may.run == 0 || may.run % group == 0);
  };
  if (caps().long_work && may.tensors == 1 && suits(kManyRows, kEnoughGroups)) return kManyRows;
  return suits(kFewRows, 1) ? kFewRows : 0;
}

void Recorder::dispatch_units(std::string_view shader, uint64_t units, const UnitRows& may,
                              std::initializer_list<Slice> bindings, const Push& push,
                              const std::vector<uint32_t>& constants) {
  const uint32_t rows = rows_of_group(units, may);
  if (rows == 0) return dispatch_flat(shader, (units + 3) / 4, bindings, push, constants);
  std::vector<uint32_t> all{caps().subgroup_size};
  all.insert(all.end(), constants.begin(), constants.end());
  all.resize(kUnitRowsId);
  all.push_back(rows);
  const uint64_t group = uint64_t{rows} * caps().subgroup_size;
  const uint64_t groups = (units + group - 1) / group;
  const uint64_t columns = std::min<uint64_t>(groups, caps().max_groups[0]);
  dispatch(shader, all, std::span(bindings.begin(), bindings.size()), push,
           {static_cast<uint32_t>(columns), static_cast<uint32_t>((groups + columns - 1) / columns), 1});
}

void Recorder::fill(const Slice& slice, uint32_t word) {
  order({}, std::span(&slice, 1));
  vkCmdFillBuffer(buffer_, slice.buffer->handle(), slice.offset, (slice.bytes + 3) / 4 * 4, word);
  recorded("fill");
}

void Recorder::copy(const Slice& from, const Slice& to) {
  if (from.storage != to.storage) throw Error("a copy between float32 and float16 was recorded");
  if (from.bytes != to.bytes)
    throw Error(fmt::format("a copy of {} bytes into {} bytes was recorded", from.bytes, to.bytes));
  order(std::span(&from, 1), std::span(&to, 1));
  const VkBufferCopy region{from.offset, to.offset, from.bytes};
  vkCmdCopyBuffer(buffer_, from.buffer->handle(), to.buffer->handle(), 1, &region);
  recorded("copy");
}

void Recorder::host_step(std::function<void()> run) {
  end_buffer();
  commands_->host_steps_.push_back({commands_->buffers_.size(), std::move(run)});
  begin_buffer();
}

void Recorder::begin_section() {
  if (chunk_flop_ > kChunkFlop || chunk_dispatches_ > kChunkDispatches) {
    end_buffer();
    begin_buffer();
  }
  section_ = commands_->sections_++;
}

void Recorder::end_section() { section_ = -1; }

void Recorder::expect_work(double flop) { chunk_flop_ += flop; }

std::unique_ptr<Commands> Recorder::finish() {
  end_buffer();
  return std::move(commands_);
}

}  // namespace vkopple
