#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/report/svg_plot.h"

namespace vkopple {

/// A quantity over the steps of a run: x is the step.
using Curve = std::vector<PlotPoint>;

/// Where a stage of training begins.
struct StageBegin {
  uint64_t step = 0;  ///< its first
  std::string name;
};

/// What the log of a run tells.
struct TrainingCurves {
  std::map<std::string, Curve> losses;    ///< by term, "total" among them
  Curve seconds;                          ///< of a step
  Curve data_seconds;                     ///< of these, until the batch was there
  std::map<std::string, Curve> held_out;  ///< "ari_fg", "iou", "depth_r", as far as they were measured
  std::vector<StageBegin> stages;
  uint64_t steps = 0;       ///< in the log
  uint64_t not_finite = 0;  ///< losses that were no number
};

/// Reads a log.jsonl (TrainingLog). A last line that is not finished is left out. Throws Error naming file and
/// line.
TrainingCurves read_training_curves(const std::filesystem::path& path);

/// What happens in a stretch of steps.
struct CurveStretch {
  double x;                ///< its middle
  double low, mean, high;  ///< of the values
};

/// The curve in at most `most` stretches of as many values, but for the last.
std::vector<CurveStretch> stretches(const Curve& curve, std::size_t most);

}  // namespace vkopple
