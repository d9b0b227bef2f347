#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>

#include "runtime/error.h"
#include "train/formats/camera_axes.h"
#include "train/formats/film_reader.h"
#include "train/formats/trajectory.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTrajectory = "groundtruth.txt";
constexpr const char* kImages = "rgb";
constexpr const char* kDepth = "depth";
constexpr double kTolerance = 0.02;    // seconds
constexpr double kDepthFactor = 5000;  // of the benchmark: steps of its 16 bits in a metre

/// Pictures by time.
using TimedImages = std::map<double, fs::path>;

/// Those of a folder whose names without the extension are timestamps.
TimedImages find_images(const fs::path& folder) {
  TimedImages images;
  std::error_code failed;
  for (auto entry = fs::directory_iterator(folder, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    const auto time = parse_finite(entry->path().stem().string());
    if (!time || !entry->path().has_extension()) continue;
    if (!images.emplace(*time, entry->path()).second)
      throw Error(fmt::format("{}: another picture has the same timestamp", entry->path().string()));
  }
  if (failed)
    throw Error(fmt::format("{}: the folder of pictures can't be read: {}", folder.string(), failed.message()));
  if (images.empty())
    throw Error(fmt::format("{}: no picture there has a timestamp for a name, like 1305031102.175304.png",
                            folder.string()));
  return images;
}

/// The choice that a setting names.
template <class Choice>
Choice chosen(const FormatOptions& options, const std::string& setting,
              const std::map<std::string, Choice>& choices, const std::string& otherwise) {
  std::vector<std::string> names;
  for (const auto& [name, choice] : choices) names.push_back(name);
  return choices.at(options.choice(setting, names, otherwise));
}

class TumRecording {
 public:
  TumRecording(const fs::path& folder, const FormatOptions& options)
      : trajectory_(folder / options.text("trajectory", kTrajectory)),
        images_(find_images(folder / options.text("images", kImages))),
        poses_(read_trajectory(trajectory_)),
        tolerance_(options.number("tolerance", 0, 1e9, kTolerance)),
        skips_(options.choice("missing", {"error", "skip"}, "error") == "skip"),
        camera_(chosen(options, "camera", camera_axes_by_name(), "optical")),
        world_(chosen(options, "world", world_axes_by_name(), "z-up")),
        depth_unit_(1 / options.number("depth_factor", 1e-6, 1e9, kDepthFactor)) {
    const fs::path depth = folder / options.text("depth", kDepth);
    std::error_code failed;
    if (options.settings.contains("depth") || fs::is_directory(depth, failed)) depths_ = find_images(depth);
  }

  std::vector<Film> films(const Cutting& cuts) const {
    std::vector<Film> films;
    std::vector<FilmFrame> stretch;  // without a gap
    const auto close = [&] {
      for (Film& film : cut_into_films(stretch, cuts, films.size())) films.push_back(std::move(film));
      stretch.clear();
    };
    for (const auto& [time, image] : images_) {
      if (const auto camera = pose_at(time, image))
        stretch.push_back(
            {.image = image, .camera = camera, .planar_depth = depth_at(time), .depth_unit = depth_unit_});
      else
        close();
    }
    close();
    return films;
  }

 private:
  /// Nothing where there is none and pictures without one are left out.
  std::optional<CameraPose> pose_at(double time, const fs::path& image) const {
    const TimedPose& pose = nearest_pose(poses_, time);
    const double away = std::abs(pose.time - time);
    if (away <= tolerance_) return own(pose);
    if (skips_) return std::nullopt;
    throw Error(
        fmt::format("{}: no pose within {} s, the nearest in {} is {:.4g} s away; allow more by "
                    "--format-option tolerance=SECONDS, or leave such pictures out by missing=skip",
                    image.string(), tolerance_, trajectory_.filename().string(), away));
  }

  CameraPose own(const TimedPose& pose) const {
    try {
      return own_pose(pose.position, pose.wxyz, camera_, world_);
    } catch (const Error& problem) {
      throw Error(fmt::format("{}: at {:.6f} s: {}", trajectory_.string(), pose.time, problem.what()));
    }
  }

  /// Empty where there is none near enough.
  fs::path depth_at(double time) const {
    const auto after = depths_.lower_bound(time);
    fs::path nearest;
    double least = tolerance_;
    for (auto candidate : {after == depths_.begin() ? after : std::prev(after), after}) {
      if (candidate == depths_.end() || std::abs(candidate->first - time) > least) continue;
      least = std::abs(candidate->first - time);
      nearest = candidate->second;
    }
    return nearest;
  }

  fs::path trajectory_;
  TimedImages images_, depths_;
  std::vector<TimedPose> poses_;
  double tolerance_;
  bool skips_;
  CameraAxes camera_;
  WorldAxes world_;
  double depth_unit_;
};

std::unique_ptr<SceneReader> open(const fs::path& path, const FormatOptions& options) {
  if (!options.settings.contains("fov"))
    throw UsageError(
        fmt::format("{}: the files don't tell the vertical angle of view; give it in degrees by "
                    "--format-option fov=DEGREES",
                    quote(path.string(), 4096)));
  std::vector<Film> films = TumRecording(path, options).films(cutting(options));
  if (films.empty())
    throw Error(fmt::format("{}: no stretch of three pictures with poses", quote(path.string(), 4096)));
  return std::make_unique<FilmReader>(std::move(films), options.degrees("fov", 1, 175, 0));
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
      {"depth", fmt::format("the folder of depth pictures, {} where it is there unless given", kDepth)},
      {"depth_factor", fmt::format("steps of depth pictures in a scene unit, {} unless given", kDepthFactor)},
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
          .write_settings = {},
          .fields = {},
          .recognises = recognises,
          .open = open};
}

}  // namespace vkopple
