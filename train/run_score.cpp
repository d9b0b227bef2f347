#include "train/run_score.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace vkopple {
namespace {

constexpr const char* kObjects = "iou+ari_fg ";
constexpr const char* kDepth = "depth_r ";

}  // namespace

std::optional<RunScore> run_score(const HeldOutScores& scores) {
  if (scores.iou && scores.ari_fg) return RunScore{true, *scores.iou + *scores.ari_fg};
  if (scores.depth_r) return RunScore{false, *scores.depth_r};
  return std::nullopt;
}

std::string to_text(const RunScore& score) {
  return fmt::format("{}{}", score.objects ? kObjects : kDepth, score.value);
}

std::optional<RunScore> parse_run_score(const std::string& text) {
  for (const bool objects : {true, false}) {
    const std::string prefix = objects ? kObjects : kDepth;
    if (!text.starts_with(prefix)) continue;
    RunScore score{objects, 0};
    const char* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data() + prefix.size(), end, score.value);
    if (failure == std::errc{} && stop == end && std::isfinite(score.value)) return score;
  }
  return std::nullopt;
}

}  // namespace vkopple
