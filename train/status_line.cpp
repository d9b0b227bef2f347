#include "train/status_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace vkopple {
namespace {

constexpr std::chrono::seconds kBetweenLines{10};

/// Of a terminal: a longer line would wrap, and could not be rewritten.
size_t columns(std::FILE* stream) {
  winsize size{};
  if (::ioctl(::fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return 80;
  return size.ws_col;
}

}  // namespace

StatusLine::StatusLine(std::FILE* stream, bool terminal)
    : stream_(stream), terminal_(terminal), shown_(std::chrono::steady_clock::now()) {}

StatusLine::StatusLine() : StatusLine(stderr, ::isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
  if (open_) fmt::print(stream_, "\n");
}

void StatusLine::show(std::string_view text, bool now) {
  const auto time = std::chrono::steady_clock::now();
  if (!terminal_ && !now && time - shown_ < kBetweenLines) return;
  shown_ = time;
  if (terminal_)
    fmt::print(stream_, "\r{}\033[K", text.substr(0, columns(stream_) - 1));
  else
    fmt::print(stream_, "{}\n", text);
  open_ = terminal_;
  std::fflush(stream_);
}

void StatusLine::say(std::string_view text) {
  if (open_) fmt::print(stream_, "\n");
  open_ = false;
  fmt::print(stream_, "{}\n", text);
  std::fflush(stream_);
}

void StatusLine::clear() {
  if (open_) fmt::print(stream_, "\r\033[K");
  open_ = false;
  std::fflush(stream_);
}

}  // namespace vkopple
