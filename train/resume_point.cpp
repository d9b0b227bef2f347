#include "train/resume_point.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "runtime/error.h"
#include "runtime/warn.h"
#include "train/checkpoint.h"

namespace vkopple {
namespace {

/// Looks through checkpoints, and remembers what is wrong with those that will not do.
class Search {
 public:
  /// Steps done, where the checkpoint is whole.
  std::optional<uint64_t> try_whole(const std::filesystem::path& path) {
    try {
      return verify_checkpoint(path).step;
    } catch (const Error& error) {
      pass_over(error.what());
      return std::nullopt;
    }
  }
  void pass_over(const std::string& why) { faults_.push_back(why); }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  std::vector<std::string> faults_;
};

}  // namespace

std::filesystem::path find_resume_point(const RunFolder& folder) {
  const std::string shown = folder.path().string();
  if (!folder.holds_checkpoint())
    throw UsageError(
        fmt::format("{}: no run to resume, there is no {}", shown, folder.latest().filename().string()));
  Search search;
  if (!std::filesystem::exists(folder.latest()))
    search.pass_over(fmt::format("{}: is missing", folder.latest().string()));
  else if (search.try_whole(folder.latest()))
    return folder.latest();

  std::optional<std::filesystem::path> found;
  uint64_t step = 0;
  const std::vector<uint64_t> steps = folder.numbered_steps();
  for (auto it = steps.rbegin(); it != steps.rend() && !found; ++it)
    if (search.try_whole(folder.numbered(*it))) {
      found = folder.numbered(*it);
      step = *it;
    }
  if (std::filesystem::exists(folder.best()))
    if (const auto best = search.try_whole(folder.best()); best && (!found || *best > step)) {
      found = folder.best();
      step = *best;
    }
  if (!found)
    throw Error(
        fmt::format("{}: no checkpoint is left to go on from ({}); put a copy of one back as {}, or "
                    "begin anew with another --out",
                    shown, fmt::join(search.faults(), "; "), folder.latest().filename().string()));
  for (const std::string& fault : search.faults()) warn("passed over: " + fault);
  warn(fmt::format("going on from {}, after step {}", found->string(), step));
  return *found;
}

}  // namespace vkopple
