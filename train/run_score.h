#pragma once

#include <compare>
#include <optional>
#include <string>

#include "train/step_record.h"

namespace vkopple {

/// How good a model is in unseen rooms, in one number, to tell the best checkpoint of a run: IoU + ARI-fg once
/// objects are learned, the correlation of depth until then. A score of objects is above any of depth alone.
struct RunScore {
  bool objects = false;
  double value = 0;

  auto operator<=>(const RunScore&) const = default;
};

/// Nothing where neither is known.
std::optional<RunScore> run_score(const HeldOutScores& scores);

/// "iou+ari_fg 1.25" or "depth_r 0.5"; read back it is the same, bit for bit.
std::string to_text(const RunScore& score);
/// Nothing for any other text.
std::optional<RunScore> parse_run_score(const std::string& text);

}  // namespace vkopple
