#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "train/step_record.h"

namespace vkopple {

/// "1:02:03" or "2:03"; days before it where there are any.
std::string duration_text(double seconds);

/// One line about a step: "120/2500 depth  total 0.0312  image 0.0312  12.3 triplets/s  3:12 left".
std::string progress_line(const StepRecord& record, uint64_t total, double seconds_per_step);

/// Tells how training goes: a line that is rewritten in place on a terminal, elsewhere a line every ten
/// seconds.
class Progress {
 public:
  Progress(std::FILE* stream, bool terminal, uint64_t total)
      : stream_(stream), terminal_(terminal), total_(total) {}
  /// To standard error; as a terminal if it is one.
  explicit Progress(uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const StepRecord& record);
  /// A line of its own.
  void say(std::string_view text);

 private:
  void learn_pace(const StepRecord& record);
  void end_line();

  std::FILE* stream_;
  bool terminal_;
  uint64_t total_;
  bool open_ = false;  ///< the cursor stands in a line that is rewritten
  std::string stage_;
  uint64_t steps_of_stage_ = 0;
  double seconds_per_step_ = 0;
  std::optional<double> depth_r_;
  std::optional<std::chrono::steady_clock::time_point> shown_;
};

}  // namespace vkopple
