#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/image.h"
#include "train/step_record.h"
#include "train/tensorboard/event_file.h"

namespace vkopple {

/// Shows a run in TensorBoard, beside its log: means over kSteps steps of every loss ("loss/…"), of
/// "speed/triplets_per_second" and "speed/data_share" (of a step's time), and "learning_rate". Steps that were
/// skipped are left out of the means, and counted in "skipped_steps" from the first on. Where they were taken,
/// "weight_norm/…" and "gradient_norm/…" by network, "held_out/…" scores, and pictures of the same few held-out
/// images.
class TrainingBoard {
 public:
  static constexpr int kSteps = 10;

  /// As EventFile.
  TrainingBoard(const std::filesystem::path& folder, uint64_t step, FileSystem& files = system_files())
      : file_(folder, step, files) {}

  void add(const StepRecord& record);
  /// Rows of pictures, as HeldOutProbe gives them.
  void show(uint64_t step, const std::vector<std::vector<RgbImage>>& rows);
  /// Writes the mean over what has come since the last; before the end, and where a stage ends.
  void flush();

 private:
  void add_measured(const StepRecord& record);

  EventFile file_;
  StepRecord last_;
  std::map<std::string, double> sums_;  ///< of losses
  double seconds_ = 0, data_seconds_ = 0;
  int steps_ = 0;  ///< since the last flush
  int good_ = 0;   ///< of these, not skipped: those in the sums
};

}  // namespace vkopple
