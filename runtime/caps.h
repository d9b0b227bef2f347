#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace vkopple {

enum class DeviceType { kDiscrete, kIntegrated, kVirtual, kCpu, kOther };

/// How kernels read and write their operands (shaders/include/access.glsl); a build variant of every shader.
enum class AccessPath {
  kTexel,    ///< uniform texel buffers, 64-bit stores: ten times as fast on lavapipe
  kStorage,  ///< storage buffers alone: works everywhere
};

/// Kernels by the mechanism that lets invocations share operands. A device of one type runs the others' kernels
/// too, slower.
enum class KernelFamily {
  kAuto,       ///< registers on CPU devices; on GPUs cooperative matrices where they lose nothing, else shared
  kRegisters,  ///< large tiles in registers, operands handed round a subgroup
  kShared,     ///< tiles in shared memory
  kCooperative,  ///< cooperative matrices for what is stored as float16, shared memory for the rest
  kPlain,        ///< what runs anywhere
};

/// A product of cooperative matrices that a subgroup does at once: m × k by k × n of float16, added to m × n of
/// float32.
struct MatrixShape {
  uint32_t m, n, k;
  bool operator==(const MatrixShape&) const = default;
};

/// Where convolutions use Winograd's algorithm, whose rounding grows with its tiles.
enum class WinogradUse {
  kNever,
  kWhereFaster,  ///< by an estimate, on CPU devices
  kTiles2,       ///< with tiles of 2 x 2 outputs wherever it can run
  kTiles4,       ///< … of 4 x 4
};

/// Choices that were measured on a device, by what they are for; what the numbers mean, and whether the device
/// can do that, the kernels' host side knows (graph/conv/conv_tuning.h).
using TunedChoices = std::map<std::string, std::vector<uint32_t>>;

/// What a device can do, as plain data: kernels are chosen from this, and tests make it up.
struct Caps {
  std::string name;
  std::string driver;  ///< name and version, as the driver gives them
  std::array<uint8_t, 16> uuid{};
  std::array<uint8_t, 16> driver_uuid{};
  uint32_t vendor_id = 0;
  uint32_t device_id = 0;
  uint32_t driver_version = 0;
  uint32_t api_version = 0;
  DeviceType type = DeviceType::kOther;

  uint64_t memory_bytes = 0;             ///< largest device-local heap
  uint64_t max_allocation_bytes = 0;     ///< of one vkAllocateMemory
  uint64_t max_storage_range = 0;        ///< bytes of one storage buffer binding
  uint64_t max_texel_elements = 0;       ///< elements of one texel buffer view
  uint64_t offset_alignment = 256;       ///< bytes; suits storage and texel bindings alike
  uint32_t max_workgroup_size = 128;     ///< invocations
  std::array<uint32_t, 3> max_groups{};  ///< of one dispatch
  uint32_t shared_memory_bytes = 16384;
  uint32_t subgroup_size = 1;
  float timestamp_period = 0;  ///< nanoseconds a tick, 0 without timestamps

  bool subgroup_shuffle = false;
  bool subgroup_arithmetic = false;
  bool int64 = false;             ///< 64-bit integers in shaders, which subgroups exchange too
  bool float_atomic_add = false;  ///< VK_EXT_shader_atomic_float on storage buffers
  std::vector<MatrixShape>
      cooperative_matrices;  ///< that kernels can use; empty: none, or a feature is missing
  bool lavapipe = false;  ///< Mesa's driver for CPUs, whose texel fetches outside a view give zeros at no cost
  AccessPath access = AccessPath::kStorage;
  bool row_stores = false;  ///< kernels of subgroups store lane by lane at uniform addresses (row_store.glsl)
  bool long_work = false;   ///< a choice: kernels may take seconds to compile where that makes them faster
  bool exact_sums = false;  ///< a choice: convolutions keep what their sums round off, several times slower
  KernelFamily kernels = KernelFamily::kAuto;        ///< a choice, for convolutions and matrix products
  WinogradUse winograd = WinogradUse::kWhereFaster;  ///< a choice, of convolutions without exact_sums
  std::shared_ptr<const TunedChoices> tuned;         ///< null: none

  bool cpu() const { return type == DeviceType::kCpu; }
  /// Invocations of a workgroup for kernels that treat every element alike.
  uint32_t flat_workgroup() const { return cpu() ? 64 : 128; }
  /// Largest tensor in bytes that one binding reaches.
  uint64_t max_tensor_bytes() const {
    const uint64_t texel = access == AccessPath::kTexel ? max_texel_elements * 4 : max_storage_range;
    return texel < max_storage_range ? texel : max_storage_range;
  }
};

/// Why the device can't run a family of kernels, in a line; empty: it can.
std::string missing_for(KernelFamily family, const Caps& caps);
/// Likewise for an access path.
std::string missing_for(AccessPath access, const Caps& caps);
/// Likewise for convolutions that are made to use Winograd's algorithm.
std::string missing_for(WinogradUse use, const Caps& caps);

/// "8c2f…" as 32 hexadecimal digits in the usual 8-4-4-4-12 grouping.
std::string uuid_text(const std::array<uint8_t, 16>& uuid);

}  // namespace vkopple
