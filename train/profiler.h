#pragma once

#include <filesystem>

#include "train/trace.h"

namespace vkopple {

/// Traces the first steps of a run, all but the very first, whose memory is new; or that one, where a run has
/// no other.
class Profiler {
 public:
  Profiler(const Caps& caps, std::filesystem::path path, int steps);

  /// Where the step that begins goes; null once there are enough.
  Trace* begin_step();
  /// Writes the file after the last step that is wanted. Throws Error.
  void end_step();
  /// Writes what there is of a run that ended before. Throws Error.
  void finish();
  bool done() const { return written_; }

 private:
  std::filesystem::path path_;
  int steps_;
  Trace first_, others_;
  int seen_ = 0;
  bool written_ = false;
};

}  // namespace vkopple
