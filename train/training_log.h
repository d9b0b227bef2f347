#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "train/append_file.h"
#include "train/step_record.h"

namespace vkopple {

/// {"step", "stage", "losses": {...}, "seconds", "data_seconds"}, of "ari_fg", "iou" and "depth_r" what was
/// measured, and "processes", "exchange_seconds", "efficiency" where there are several processes. A step that
/// was skipped has "skipped_steps", and null for a loss that was not finite.
nlohmann::ordered_json to_json(const StepRecord& record);

/// The log of a run: such an object a line and step. Throws Error naming the file.
class TrainingLog {
 public:
  /// Opens it to go on after `step` steps: what it holds from the first line on that belongs to a later step,
  /// or is no such line, is cut off.
  TrainingLog(const std::filesystem::path& path, uint64_t step, FileSystem& files = system_files());

  void add(const StepRecord& record);

 private:
  AppendFile file_;
};

}  // namespace vkopple
