#include "train/checkpoint_keeper.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "runtime/error.h"
#include "runtime/warn.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

constexpr const char* kScore = "score";

/// Of a best checkpoint; nothing where there is none, or it is damaged.
std::optional<RunScore> score_of(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const SafetensorsFile file(path);
    const auto found = file.metadata().find(kScore);
    if (found != file.metadata().end()) return parse_run_score(found->second);
  } catch (const Error& error) {
    warn(fmt::format("{}; the next measurement takes its place", error.what()));
  }
  return std::nullopt;
}

}  // namespace

CheckpointKeeper::CheckpointKeeper(RunFolder folder, uint64_t keep, bool resumed, FileSystem& files,
                                   Write write)
    : folder_(std::move(folder)), keep_(keep), files_(&files), write_(std::move(write)) {
  if (resumed) best_ = score_of(folder_.best());
}

void CheckpointKeeper::save_numbered(uint64_t step) {
  write_(folder_.numbered(step), {});
  save_latest();
  remove_old(step);
}

void CheckpointKeeper::save_if_best(const HeldOutScores& scores) {
  const auto score = run_score(scores);
  if (!score || (best_ && *score <= *best_)) return;
  write_(folder_.best(), {{kScore, to_text(*score)}});
  best_ = score;
}

void CheckpointKeeper::remove_old(uint64_t step) const {
  if (keep_ == 0) return;
  std::vector<uint64_t> steps = folder_.numbered_steps();
  std::erase_if(steps, [&](uint64_t other) { return other > step; });
  for (size_t i = 0; i + keep_ < steps.size(); ++i) {
    const auto path = folder_.numbered(steps[i]);
    if (files_->unlink(path.c_str()) != 0)
      warn(fmt::format("{}: cannot be removed: {}; remove it yourself", path.string(),
                       std::generic_category().message(errno)));
  }
}

}  // namespace vkopple
