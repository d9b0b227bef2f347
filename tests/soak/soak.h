#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runtime/device.h"
#include "tests/support/vulkan_objects.h"

namespace vkopple::test {

/// What a process holds at a moment.
struct Holdings {
  uint64_t resident_bytes = 0;  ///< of the process, memory of CPU devices included
  uint64_t descriptors = 0;     ///< open files
  VulkanObjects vulkan;

  static Holdings now();
};

/// Work of one kind, and what was held after each of its rounds. In a round everything that the work does only
/// now and then was done.
struct SoakPhase {
  std::string name;
  uint64_t each = 0;  ///< steps or inferences of a round
  std::vector<Holdings> rounds;
};

struct SoakOptions {
  std::filesystem::path folder;  ///< empty, for runs and images
  uint64_t steps = 0;  ///< of training, in all; at least 6 · kSoakRound, without all networks 4 · kSoakRound
  bool all_networks = true;  ///< false: the depth network alone, whose steps take a third of the time
  uint64_t inferences = 0;   ///< at least 2 · kSoakRound
};

/// Steps after which training has done all that it does now and then (norms are told every 50 steps).
inline constexpr uint64_t kSoakRound = 50;

/// Trains and infers in this process: the depth network alone, then all networks, then these on shards in
/// files, with checkpoints, measurements and a log; then single images from files to masks, depth and objects
/// in files, with a model opened anew for every round. 16 × 16 pixels, batches of 2. `told` of every round.
std::vector<SoakPhase> soak(const Device& device, const SoakOptions& options,
                            const std::function<void(const SoakPhase&)>& told = {});

/// What of a phase grew after its first round, which is for warming up, a line each; memory of the host in the
/// second half of the rounds, by more than `resident_slack` bytes: threads that read ahead come to their share
/// of the allocator one by one.
std::vector<std::string> growth(const SoakPhase& phase, uint64_t resident_slack);

}  // namespace vkopple::test
