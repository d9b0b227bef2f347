#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "train/status_line.h"
#include "train/step_record.h"

namespace vkopple {

/// "1:02:03" or "2:03"; days before it where there are any.
std::string duration_text(double seconds);

/// One line about a step: "120/2500 depth  total 0.0312  image 0.0312  12.3 triplets/s  3:12 left".
std::string progress_line(const StepRecord& record, uint64_t total, double seconds_per_step);

/// Tells how training goes, in a StatusLine.
class Progress {
 public:
  Progress(std::FILE* stream, bool terminal, uint64_t total) : line_(stream, terminal), total_(total) {}
  /// To standard error; as a terminal if it is one.
  explicit Progress(uint64_t total) : total_(total) {}

  void show(const StepRecord& record);
  /// A line of its own.
  void say(std::string_view text) { line_.say(text); }

 private:
  void learn_pace(const StepRecord& record);

  StatusLine line_;
  uint64_t total_;
  bool begun_ = false;
  std::string stage_;
  uint64_t steps_of_stage_ = 0;
  double seconds_per_step_ = 0;
  std::optional<HeldOutScores> held_out_;  ///< as measured last
};

}  // namespace vkopple
