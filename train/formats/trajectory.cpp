#include "train/formats/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;
constexpr std::size_t kNumbers = 8;  // of a line

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r,";
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(kSpace); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSpace, end);
  }
  return words;
}

std::optional<TimedPose> parse_pose(const std::vector<std::string_view>& words) {
  if (words.size() != kNumbers) return std::nullopt;
  std::array<double, kNumbers> n{};
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const auto value = parse_finite(words[i]);
    if (!value) return std::nullopt;
    n[i] = *value;
  }
  return TimedPose{n[0], {n[1], n[2], n[3]}, {n[7], n[4], n[5], n[6]}};
}

}  // namespace

std::optional<double> parse_finite(std::string_view text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<TimedPose> read_trajectory(const std::filesystem::path& path) {
  const std::string text = read_text_file(path, kMaxTextBytes);
  std::vector<TimedPose> poses;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const auto words = words_of(line);
    if (words.empty() || words[0].starts_with('#')) continue;
    const auto pose = parse_pose(words);
    if (!pose)
      throw Error(fmt::format("{}: line {}: must be eight numbers, timestamp tx ty tz qx qy qz qw, not {}",
                              path.string(), number, quote(line)));
    poses.push_back(*pose);
  }
  if (poses.empty()) throw Error(fmt::format("{}: no poses", path.string()));
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.time < b.time; });
  return poses;
}

const TimedPose& nearest_pose(const std::vector<TimedPose>& poses, double time) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                      [](const TimedPose& pose, double t) { return pose.time < t; });
  if (after == poses.begin()) return poses.front();
  if (after == poses.end() || time - std::prev(after)->time <= after->time - time) return *std::prev(after);
  return *after;
}

}  // namespace vkopple
