#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "models/config.h"
#include "train/file_system.h"
#include "train/run_folder.h"

namespace vkopple::test {

/// All that a run leaves in its folder but for times: the bytes of checkpoints by their names and, by "log N",
/// the N-th line of the log without seconds.
std::map<std::string, std::vector<std::byte>> remains_of(const std::filesystem::path& run);

/// A run of a few steps of the depth network on 16 × 16 pixels, with a checkpoint after every step.
struct TinyRun {
  std::filesystem::path folder;
  uint64_t steps = 3;
  uint64_t keep = 0;
  uint64_t eval_every = 0;
  uint64_t max_bad_steps = 10;

  static Config config();

  /// What `vkopple train` does: begins the run or, where there is a checkpoint, goes on with it; until `stop`
  /// says so after a step. Whether it came to its end. `shown` grows by one with every step that is told of.
  bool train(
      FileSystem& files = system_files(), uint64_t* shown = nullptr,
      const std::function<bool()>& stop = [] { return false; }) const;

  std::map<std::string, std::vector<std::byte>> remains() const { return remains_of(folder); }
};

}  // namespace vkopple::test
