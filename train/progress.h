#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "train/colours.h"
#include "train/status_line.h"
#include "train/step_record.h"
#include "train/training_listener.h"

namespace vkopple {

/// "1:02:03" or "2:03"; days before it where there are any.
std::string duration_text(double seconds);

/// One line about a step: "120/2500 depth  total 0.0312  image 0.0312  12.3 triplets/s  3:12 left".
std::string progress_line(const StepRecord& record, uint64_t total, double seconds_per_step,
                          const Colours& colours = Colours(false));

/// Tells how training goes, in a StatusLine.
class Progress final : public TrainingListener {
 public:
  Progress(std::FILE* stream, bool terminal, uint64_t total, const Colours& colours = Colours(false))
      : line_(stream, terminal), total_(total), colours_(colours) {}
  /// To standard error; as a terminal if it is one.
  explicit Progress(uint64_t total) : total_(total), colours_(may_have_colours(stderr)) {}

  void show(const StepRecord& record) override;
  /// A line of its own.
  void say(std::string_view text) override { line_.say(text); }

 private:
  void learn_pace(const StepRecord& record);

  StatusLine line_;
  uint64_t total_;
  Colours colours_;
  bool begun_ = false;
  std::string stage_;
  uint64_t steps_of_stage_ = 0;
  double seconds_per_step_ = 0;
  std::optional<HeldOutScores> held_out_;  ///< as measured last
};

}  // namespace vkopple
