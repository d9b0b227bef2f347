#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "runtime/bounds.h"
#include "runtime/buffer.h"
#include "runtime/caps.h"
#include "runtime/dispatch.h"
#include "runtime/shader_library.h"

namespace vkopple {

class Device;
struct Pipeline;

/// Push constants of a dispatch: a plain struct laid out as the shader's block (scalars of 4 bytes), at most
/// 128 bytes.
class Push {
 public:
  Push() = default;
  template <class T>
  // NOLINTNEXTLINE(google-explicit-constructor): reads as the block itself
  requires std::is_trivially_copyable_v<T> Push(const T& values) : bytes_(sizeof(T)) {
    static_assert(sizeof(T) <= 128 && sizeof(T) % 4 == 0);
    std::memcpy(data_.data(), &values, sizeof(T));
  }
  uint32_t bytes() const { return bytes_; }
  const void* data() const { return data_.data(); }

 private:
  std::array<std::byte, 128> data_{};
  uint32_t bytes_ = 0;
};

/// Whether a kernel's workgroups may store rows of vec4s, which then must start at even vec4s of what is
/// written.
struct UnitRows {
  bool allowed = false;
  uint64_t run = 0;  ///< each workgroup's rows must lie in one run of so many units; 0: anywhere
  int tensors = 1;   ///< that are stored to: the more, the longer is the code of a row
};

/// When commands went to the device and were waited for.
struct RunTimes {
  std::chrono::steady_clock::time_point begin;      ///< before the first submission
  std::chrono::steady_clock::time_point submitted;  ///< after the last
  std::chrono::steady_clock::time_point end;        ///< all done
};

/// One dispatch, fill or copy of the last run, on the device's clock. It begins where the one before it in its
/// chunk ended, so that what a device overlaps is counted once.
struct CommandTime {
  std::string name;  ///< the shader, "fill" or "copy"
  int section = -1;  ///< counted from 0 in order of recording; -1: in none
  double begin = 0;  ///< seconds
  double end = 0;
};

/// What a recorder left: command buffers, replayed as often as wanted. The slices it names must outlive it.
class Commands {
 public:
  explicit Commands(const Device& device);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// Submits every chunk in order and waits for the last one, and for those before a host step. What a host
  /// step throws ends it. Nothing is under way when it returns or throws.
  RunTimes run() const;
  /// Of the last run, in order of recording; empty unless recorded with timestamps.
  std::vector<CommandTime> command_times() const;
  size_t dispatches() const { return dispatches_; }
  size_t barriers() const { return barriers_; }
  size_t chunks() const { return buffers_.size(); }

 private:
  friend class Recorder;
  const Device* device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  std::vector<VkCommandBuffer> buffers_;
  std::vector<VkDescriptorPool> descriptor_pools_;
  /// A command between two timestamps.
  struct Timed {
    std::string name;
    int section;
    uint32_t begin;  ///< its query
    uint32_t end;
  };
  /// Work of the host between two chunks.
  struct HostStep {
    size_t chunks;  ///< that must be done before
    std::function<void()> run;
  };
  RunTimes submit_all() const;
  void submit(VkCommandBuffer buffer, VkFence fence) const;
  void wait() const;
  std::vector<HostStep> host_steps_;
  int sections_ = 0;
  std::vector<Timed> timed_;
  uint32_t stamps_ = 0;  ///< queries that are written
  static constexpr uint64_t kAbsentBytes = 256;
  /// Bound where an optional operand is absent: one part where kernels would read, one where they would write.
  /// Bands of kGuardBytes lie round the two.
  Slice absent(bool writes);
  std::unique_ptr<Buffer> absent_;
  size_t dispatches_ = 0;
  size_t barriers_ = 0;
};

/// Records dispatches, fills and copies. It knows what each one reads and writes and places a barrier exactly
/// where bytes that overlap are written by one side; callers never do. Long recordings are cut into chunks that
/// are submitted one by one, so that no watchdog sees a submission of many seconds.
class Recorder {
 public:
  /// `timestamps`: Commands tell how long each command takes. Throws Error for more commands than the
  /// timestamps hold. `bounds`: kGuarded only for memory that a GuardedMemory gave.
  explicit Recorder(const Device& device, bool timestamps = false, Bounds bounds = Bounds::kExact);
  /// Records nothing and needs no device: tells `sink` of every dispatch that a device of such caps would be
  /// given. What refuses dispatches refuses them here too. Slices are not looked into. `caps` must outlive it.
  Recorder(const Caps& caps, std::function<void(const Dispatch&)> sink);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Of a recorder that has one.
  const Device& device() const { return *device_; }
  const Caps& caps() const;

  /// Runs `shader` (a name of the shader library). constants[i] sets constant_id i; id 0 is local_size_x.
  /// bindings[i] is binding i, an empty slice where the kernel's optional operand is absent.
  void dispatch(std::string_view shader, const std::vector<uint32_t>& constants,
                std::span<const Slice> bindings, const Push& push, Groups groups);
  void dispatch(std::string_view shader, const std::vector<uint32_t>& constants,
                std::initializer_list<Slice> bindings, const Push& push, Groups groups) {
    dispatch(shader, constants, std::span(bindings.begin(), bindings.size()), push, groups);
  }
  /// One invocation for each of `count` elements, numbered by flat_index() of access.glsl; invocations from
  /// `count` on must return. `constants` start at constant_id 1.
  void dispatch_flat(std::string_view shader, uint64_t count, std::initializer_list<Slice> bindings,
                     const Push& push, const std::vector<uint32_t>& constants = {});
  /// Runs a kernel of shaders/include/unit_rows.glsl on `units` vec4s or words. Its workgroups store rows where
  /// they may, the device does (Caps::row_stores), and units are even and enough.
  void dispatch_units(std::string_view shader, uint64_t units, const UnitRows& may,
                      std::initializer_list<Slice> bindings, const Push& push,
                      const std::vector<uint32_t>& constants = {});

  /// Sets every 32-bit word.
  void fill(const Slice& slice, uint32_t word = 0);
  void copy(const Slice& from, const Slice& to);

  /// Has the host do something in every run, when all that was recorded before is done and nothing of what
  /// follows has begun. It may read and write the device's memory (runtime/transfer.h).
  void host_step(std::function<void()> run);

  /// Brackets what one op records, for CommandTime::section.
  void begin_section();
  void end_section();
  /// Tells how much work follows (multiply-adds count two), for cutting into chunks.
  void expect_work(double flop);

  /// Ends the recording; null without a device.
  std::unique_ptr<Commands> finish();

 private:
  /// Of dispatch_units; 0: it stores none.
  uint32_t rows_of_group(uint64_t units, const UnitRows& may) const;
  const std::vector<BindingKind>& kinds_of(std::string_view shader);
  void begin_buffer();
  void end_buffer();
  void stamp();
  /// Told after each command that is recorded.
  void recorded(std::string_view name);
  void order(std::span<const Slice> reads, std::span<const Slice> writes);
  Slice bound_part(const Slice& slice) const;
  VkDescriptorSet make_set(const Pipeline& pipeline, std::span<const Slice> bindings);
  VkDescriptorSet allocate_set(const Pipeline& pipeline);

  const Device* device_ = nullptr;
  const Caps* caps_;
  std::function<void(const Dispatch&)> sink_;
  std::map<std::string, std::vector<BindingKind>, std::less<>> kinds_;  ///< by shader
  bool timestamps_ = false;
  Bounds bounds_ = Bounds::kExact;
  std::unique_ptr<Commands> commands_;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  std::vector<Slice> pending_reads_;
  std::vector<Slice> pending_writes_;
  uint32_t sets_left_ = 0;
  size_t chunk_dispatches_ = 0;
  double chunk_flop_ = 0;
  int section_ = -1;
};

}  // namespace vkopple
