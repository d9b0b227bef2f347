#pragma once

#include <chrono>
#include <cstdio>
#include <string_view>

namespace vkopple {

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
