#include "train/status_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>

#include "train/colours.h"

namespace vkopple {
namespace {

constexpr std::chrono::seconds kBetweenLines{10};

/// Of a terminal: a longer line would wrap, and could not be rewritten.
size_t columns(std::FILE* stream) {
  winsize size{};
  if (::ioctl(::fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return 80;
  return size.ws_col;
}

/// Bytes of the escape sequence for a colour that `text` begins with, 0 where there is none.
size_t colour_bytes(std::string_view text) {
  if (!text.starts_with("\033[")) return 0;
  const size_t end = text.find('m');
  return end == std::string_view::npos ? 0 : end + 1;
}

}  // namespace

std::string cut_to_columns(std::string_view line, size_t columns) {
  size_t taken = 0;
  bool colours = false;
  for (size_t used = 0; taken < line.size();) {
    if (const size_t bytes = colour_bytes(line.substr(taken)); bytes > 0) {
      colours = true;
      taken += bytes;
      continue;
    }
    if (++used > columns) break;
    ++taken;
  }
  return std::string(line.substr(0, taken)) + (colours && taken < line.size() ? "\033[0m" : "");
}

StatusLine::StatusLine(std::FILE* stream, bool terminal)
    : stream_(stream), terminal_(terminal), shown_(std::chrono::steady_clock::now()) {}

StatusLine::StatusLine() : StatusLine(stderr, is_terminal(stderr)) {}

StatusLine::~StatusLine() {
  if (open_) fmt::print(stream_, "\n");
}

void StatusLine::show(std::string_view text, bool now) {
  const auto time = std::chrono::steady_clock::now();
  if (!terminal_ && !now && time - shown_ < kBetweenLines) return;
  shown_ = time;
  if (terminal_)
    fmt::print(stream_, "\r{}\033[K", cut_to_columns(text, columns(stream_) - 1));
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
