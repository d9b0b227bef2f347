#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace vkopple {

/// As much of a line of ASCII as takes so many columns of a terminal, of which colours take none. They end with
/// it.
std::string cut_to_columns(std::string_view line, size_t columns);

/// A line that tells how work goes: rewritten in place on a terminal, elsewhere a line every ten seconds.
class StatusLine {
 public:
  StatusLine(std::FILE* stream, bool terminal);
  /// Standard error; as a terminal if it is one.
  StatusLine();
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// `now`: also where no line is due.
  void show(std::string_view text, bool now = false);
  /// A line of its own, which stays.
  void say(std::string_view text);
  /// Takes a line that is rewritten off the terminal.
  void clear();

 private:
  std::FILE* stream_;
  bool terminal_;
  bool open_ = false;  ///< the cursor stands in a line that is rewritten
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace vkopple
