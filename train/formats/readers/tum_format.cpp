#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/formats/camera_axes.h"
#include "train/formats/film_reader.h"
#include "train/formats/inside.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;
constexpr const char* kTrajectory = "groundtruth.txt";
constexpr const char* kImages = "rgb";
constexpr double kTolerance = 0.02;  // seconds

/// A trajectory: timestamp, tx ty tz, qx qy qz qw.
using Row = std::array<double, 8>;

std::optional<double> to_number(std::string_view text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

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

std::vector<Row> read_trajectory(const fs::path& path) {
  const std::string text = read_text_file(path, kMaxTextBytes);
  std::vector<Row> rows;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const auto words = words_of(line);
    if (words.empty() || words[0].starts_with('#')) continue;
    Row row{};
    bool sound = words.size() == row.size();
    for (std::size_t i = 0; sound && i < row.size(); ++i) {
      const auto value = to_number(words[i]);
      sound = value.has_value();
      row[i] = value.value_or(0);
    }
    if (!sound)
      throw Error(fmt::format("{}: line {}: must be eight numbers, timestamp tx ty tz qx qy qz qw, not {}",
                              path.string(), number, quote(line)));
    rows.push_back(row);
  }
  if (rows.empty()) throw Error(fmt::format("{}: no poses", path.string()));
  std::sort(rows.begin(), rows.end());
  return rows;
}

const Row& nearest(const std::vector<Row>& rows, double time) {
  const auto after =
      std::lower_bound(rows.begin(), rows.end(), time, [](const Row& row, double t) { return row[0] < t; });
  if (after == rows.begin()) return rows.front();
  if (after == rows.end() || time - (*std::prev(after))[0] <= (*after)[0] - time) return *std::prev(after);
  return *after;
}

/// Pictures by time: their names without the extension are timestamps.
std::multimap<double, fs::path> find_images(const fs::path& folder) {
  std::multimap<double, fs::path> images;
  std::error_code failed;
  for (auto entry = fs::directory_iterator(folder, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    const std::string stem = entry->path().stem().string();
    if (const auto time = to_number(stem); time && entry->path().has_extension())
      images.emplace(*time, entry->path());
  }
  if (failed)
    throw Error(fmt::format("{}: the folder of pictures can't be read: {}", folder.string(), failed.message()));
  if (images.empty())
    throw Error(fmt::format("{}: no picture there has a timestamp for a name, like 1305031102.175304.png",
                            folder.string()));
  return images;
}

CameraPose pose_of(const Row& row, CameraAxes camera, WorldAxes world, const fs::path& trajectory) {
  try {
    return own_pose({row[1], row[2], row[3]}, {row[7], row[4], row[5], row[6]}, camera, world);
  } catch (const Error& problem) {
    throw Error(fmt::format("{}: at {:.6f} s: {}", trajectory.string(), row[0], problem.what()));
  }
}

/// The choice that a setting names.
template <class Choice>
Choice chosen(const FormatOptions& options, const std::string& setting,
              const std::map<std::string, Choice>& choices, const std::string& otherwise) {
  std::vector<std::string> names;
  for (const auto& [name, choice] : choices) names.push_back(name);
  return choices.at(options.choice(setting, names, otherwise));
}

std::unique_ptr<SceneReader> open(const fs::path& path, const FormatOptions& options) {
  if (!options.settings.contains("fov"))
    throw UsageError(
        fmt::format("{}: the files don't tell the vertical angle of view; give it in degrees by "
                    "--format-option fov=DEGREES",
                    quote(path.string(), 4096)));
  const double fov = options.degrees("fov", 1, 175, 0);
  const double tolerance = options.number("tolerance", 0, 1e9, kTolerance);
  const bool skips = options.choice("missing", {"error", "skip"}, "error") == "skip";
  const auto camera = chosen(options, "camera", camera_axes_by_name(), "optical");
  const auto world = chosen(options, "world", world_axes_by_name(), "z-up");
  const Cutting cuts = cutting(options);
  const fs::path trajectory = path / options.text("trajectory", kTrajectory);
  const std::vector<Row> rows = read_trajectory(trajectory);

  std::vector<Film> films;
  std::vector<FilmFrame> stretch;  // without a gap
  const auto close = [&] {
    for (Film& film : cut_into_films(stretch, cuts, films.size())) films.push_back(std::move(film));
    stretch.clear();
  };
  for (const auto& [time, image] : find_images(path / options.text("images", kImages))) {
    const Row& row = nearest(rows, time);
    if (!(std::abs(row[0] - time) <= tolerance)) {
      if (!skips)
        throw Error(
            fmt::format("{}: no pose within {} s, the nearest in {} is {:.4g} s away; allow more by "
                        "--format-option tolerance=SECONDS, or leave such pictures out by missing=skip",
                        image.string(), tolerance, trajectory.filename().string(), std::abs(row[0] - time)));
      close();
      continue;
    }
    stretch.push_back({image, pose_of(row, camera, world, trajectory), {}, std::nullopt});
  }
  close();
  if (films.empty())
    throw Error(fmt::format("{}: no stretch of three pictures with poses", quote(path.string(), 4096)));
  return std::make_unique<FilmReader>(std::move(films), fov);
}

bool recognises(const fs::path& path) {
  std::error_code failed;
  return fs::is_regular_file(path / kTrajectory, failed) && fs::is_directory(path / kImages, failed);
}

}  // namespace

SceneFormat tum_format() {
  std::vector<NamedHelp> settings{
      {"fov", "vertical angle of view in degrees; must be given"},
      {"trajectory", fmt::format("the file of poses, {} unless given", kTrajectory)},
      {"images", fmt::format("the folder of pictures, {} unless given", kImages)},
      {"camera",
       "axes of the camera's frame: optical (x right, y down, z forward), own, graphics (y up, z backward) "
       "or body (x forward, y left); optical unless given"},
      {"world", "z-up, y-up or y-down; z-up unless given"},
      {"tolerance", fmt::format("seconds between a picture and its pose, {} unless given", kTolerance)},
      {"missing", "what to do with pictures without a pose: error or skip; error unless given"}};
  for (const NamedHelp& help : cutting_help()) settings.push_back(help);
  return {.name = "tum",
          .about = "a recording: pictures named by timestamp and a trajectory, timestamp tx ty tz qx qy qz qw",
          .settings = settings,
          .fields = {},
          .recognises = recognises,
          .open = open};
}

}  // namespace vkopple
