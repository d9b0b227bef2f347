#include "train/count_progress.h"

#include <fmt/format.h>

#include "train/progress.h"

namespace vkopple {

std::string count_line(uint64_t done, uint64_t total, const std::string& things, double seconds) {
  const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
  if (total == 0) return fmt::format("{} {}", done, things);
  const std::string line = fmt::format("{}/{} {}", done, total, things);
  if (rate == 0) return line;
  const auto left = static_cast<double>(total > done ? total - done : 0);
  return line + fmt::format("  {:.3g} {}/s  {} left", rate, things, duration_text(left / rate));
}

void CountProgress::show(uint64_t done) {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
  line_.show(count_line(done, total_, things_, passed.count()));
}

}  // namespace vkopple
