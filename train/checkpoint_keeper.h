#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "train/file_system.h"
#include "train/run_folder.h"
#include "train/run_score.h"

namespace vkopple {

/// Decides which checkpoints of a run are written and which stay. A file is removed only once a newer one is
/// safely on disk.
class CheckpointKeeper {
 public:
  /// Writes a checkpoint of what training has come to; `more` goes into its metadata.
  using Write =
      std::function<void(const std::filesystem::path& path, const std::map<std::string, std::string>& more)>;

  /// `keep`: numbered checkpoints that stay, the last ones; 0: all. `resumed`: the folder has a run, whose best
  /// checkpoint stays until there is a better one.
  CheckpointKeeper(RunFolder folder, uint64_t keep, bool resumed, FileSystem& files, Write write);

  void save_latest() { write_(folder_.latest(), {}); }
  /// After `step` steps: the numbered one, then the latest, then removes what is not to be kept. Of later
  /// steps, which a run that was resumed from an earlier one comes to again, it removes none.
  void save_numbered(uint64_t step);
  /// The best, where no better one was measured before.
  void save_if_best(const HeldOutScores& scores);
  /// What a process that was killed after a numbered checkpoint did not come to remove.
  void remove_old(uint64_t step) const;

 private:
  RunFolder folder_;
  uint64_t keep_;
  FileSystem* files_;
  Write write_;
  std::optional<RunScore> best_;
};

}  // namespace vkopple
