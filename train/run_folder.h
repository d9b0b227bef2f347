#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace vkopple {

/// What lies where in the folder of a training run.
class RunFolder {
 public:
  explicit RunFolder(std::filesystem::path path) : path_(std::move(path)) {}

  /// Makes the folder where there is none. Throws Error.
  void create() const;
  /// Removes what processes that were killed left of checkpoints half written. No other may write here.
  void remove_remains() const;
  /// Whether a run has left a checkpoint here.
  bool holds_checkpoint() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path log() const { return path_ / "log.jsonl"; }
  std::filesystem::path latest() const { return path_ / "latest.safetensors"; }
  /// What did best in unseen rooms so far.
  std::filesystem::path best() const { return path_ / "best.safetensors"; }
  /// step-000123.safetensors
  std::filesystem::path numbered(uint64_t step) const;
  /// Steps of the numbered checkpoints that are here, ascending.
  std::vector<uint64_t> numbered_steps() const;

 private:
  std::filesystem::path path_;
};

/// The checkpoint that a user names: a file, or the folder of a run, whose latest is meant.
std::filesystem::path named_checkpoint(const std::filesystem::path& path);

}  // namespace vkopple
