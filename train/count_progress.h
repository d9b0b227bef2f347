#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "train/status_line.h"

namespace vkopple {

/// "120/1000 scenes  12.3 scenes/s  1:12 left"; "120 scenes" where no total is known (0).
std::string count_line(uint64_t done, uint64_t total, const std::string& things, double seconds);

/// Tells how a long row of equal things gets done. Short work says nothing where there is no terminal; at the
/// end the line goes away, so that what failed or was found stands alone.
class CountProgress {
 public:
  CountProgress(std::string things, uint64_t total) : things_(std::move(things)), total_(total) {}
  ~CountProgress() { line_.clear(); }
  CountProgress(const CountProgress&) = delete;
  CountProgress& operator=(const CountProgress&) = delete;

  void show(uint64_t done);
  /// Where it turns out that there is more to do; 0: nobody knows how much.
  void set_total(uint64_t total) { total_ = total; }
  /// Before anything else is written to standard error.
  void clear() { line_.clear(); }

 private:
  std::string things_;
  uint64_t total_;
  StatusLine line_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace vkopple
