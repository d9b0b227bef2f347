#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/formats/camera_axes.h"
#include "train/formats/film_reader.h"
#include "train/formats/inside.h"
#include "train/image_io.h"
#include "train/json_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kPoses = "poses.json";

template <std::size_t N>
std::array<double, N> numbers(const JsonView& view) {
  const std::vector<double> values = view.numbers(N);
  std::array<double, N> result{};
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

/// One frame of poses.json.
struct Entry {
  std::string scene;
  FilmFrame frame;
  std::vector<std::string> shapes;
};

/// poses.json as docs/data.md describes it.
class Recording {
 public:
  explicit Recording(const fs::path& folder)
      : folder_(folder), json_(read_json(folder / kPoses)), view_(json_, (folder / kPoses).string()) {
    if (!view_.contains("axes")) return;
    camera_axes_ = named(view_["axes"]["camera"], camera_axes_by_name());
    world_axes_ = named(view_["axes"]["world"], world_axes_by_name());
  }

  double fov() const {
    const bool in_degrees = view_.contains("fov_degrees");
    const JsonView stored = view_[in_degrees ? "fov_degrees" : "fov"];
    const double fov = in_degrees ? stored.number() * std::numbers::pi / 180 : stored.number();
    if (!(fov > 0 && fov < std::numbers::pi)) stored.fail("an angle between nothing and half a turn");
    return fov;
  }

  std::vector<Film> films(const Cutting& cutting) const {
    const std::vector<Entry> entries = read_entries();
    const bool by_name =
        std::any_of(entries.begin(), entries.end(), [](const Entry& e) { return !e.scene.empty(); });
    if (by_name) return films_by_name(entries);
    std::vector<FilmFrame> frames;
    for (const Entry& entry : entries) frames.push_back(entry.frame);
    return cut_into_films(frames, cutting, 0);
  }

 private:
  std::vector<Entry> read_entries() const {
    const JsonView frames = view_["frames"];
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < frames.size(); ++i) entries.push_back(read_entry(frames[i]));
    return entries;
  }

  Entry read_entry(const JsonView& view) const {
    Entry entry;
    entry.frame.image = inside(folder_, view["image"].string(), view["image"].where());
    if (view.contains("layers"))
      entry.frame.layers = inside(folder_, view["layers"].string(), view["layers"].where());
    if (view.contains("scene")) entry.scene = view["scene"].string();
    entry.frame.camera = camera(view);
    if (view.contains("objects")) read_objects(view["objects"], entry);
    return entry;
  }

  std::optional<CameraPose> camera(const JsonView& view) const {
    if (view.contains("camera")) return numbers<6>(view["camera"]);
    if (!view.contains("position")) return std::nullopt;
    const auto quaternion = view["quaternion"];
    try {
      return own_pose(numbers<3>(view["position"]), numbers<4>(quaternion), camera_axes_, world_axes_);
    } catch (const Error& problem) {
      throw Error(fmt::format("{}: {}", quaternion.where(), problem.what()));
    }
  }

  static void read_objects(const JsonView& listed, Entry& entry) {
    entry.frame.objects.emplace();
    for (std::size_t i = 0; i < listed.size(); ++i) {
      PlacedObject object{numbers<3>(listed[i]["location"]), std::nullopt};
      if (listed[i].contains("yaw")) object.yaw = listed[i]["yaw"].number();
      entry.frame.objects->push_back(object);
      entry.shapes.push_back(listed[i].contains("shape") ? listed[i]["shape"].string() : "");
    }
  }

  std::vector<Film> films_by_name(const std::vector<Entry>& entries) const {
    std::vector<Film> films;
    for (const Entry& entry : entries) {
      if (films.empty() || films.back().key != entry.scene) films.push_back({entry.scene, {}, entry.shapes});
      films.back().frames.push_back(entry.frame);
    }
    return films;
  }

  template <class Choice>
  static Choice named(const JsonView& view, const std::map<std::string, Choice>& choices) {
    const auto found = choices.find(view.string());
    if (found != choices.end()) return found->second;
    std::string known;
    for (const auto& [name, choice] : choices) known += (known.empty() ? "" : ", ") + name;
    view.fail("one of " + known);
  }

  fs::path folder_;
  Json json_;
  JsonView view_;
  CameraAxes camera_axes_ = CameraAxes::kOwn;
  WorldAxes world_axes_ = WorldAxes::kZUp;
};

ordered_json object_json(const PlacedObject& object, const std::string& shape) {
  ordered_json json{{"location", object.location}};
  if (object.yaw) json["yaw"] = *object.yaw;
  if (!shape.empty()) json["shape"] = shape;
  return json;
}

/// Pictures, EXR of what is known beside them, and poses.json at the end.
class RecordingWriter : public SceneWriter {
 public:
  explicit RecordingWriter(fs::path folder) : folder_(std::move(folder)) {
    std::error_code failed;
    fs::create_directories(folder_, failed);
    if (failed)
      throw Error(
          fmt::format("{}: the folder cannot be made: {}", quote(folder_.string(), 4096), failed.message()));
    if (fs::exists(folder_ / kPoses))
      throw Error(fmt::format("{} holds {} already; remove the old recording or choose another folder",
                              quote(folder_.string(), 4096), kPoses));
    json_["frames"] = ordered_json::array();
  }

  void add(const SceneData& scene) override {
    if (!fov_) fov_ = scene.fov;
    if (std::abs(*fov_ - scene.fov) > 1e-9)
      throw Error(
          fmt::format("{}: its angle of view is {} and that of scenes before {}; a recording has one, choose "
                      "it by --fov",
                      one_line(scene.source, 4096), scene.fov, *fov_));
    for (std::size_t i = 0; i < scene.frames.size(); ++i) add_frame(scene, i);
  }

  void finish() override {
    ordered_json whole{{"fov", fov_.value_or(0)}};
    whole.update(json_);
    write_file(folder_ / kPoses, whole.dump(1) + "\n");
  }

 private:
  void add_frame(const SceneData& scene, std::size_t index) {
    const SceneFrame& frame = scene.frames[index];
    const std::string name = fmt::format("{}-{:03}", scene.key, index);
    ordered_json json{{"scene", scene.key}, {"image", name + ".png"}};
    write_png(folder_ / (name + ".png"), frame.image);
    if (frame.camera) json["camera"] = *frame.camera;
    if (!frame.depth.pixels.empty() || !frame.ids.pixels.empty()) {
      write_file(folder_ / (name + ".exr"), encode_exr({frame.depth, frame.ids}));
      json["layers"] = name + ".exr";
    }
    if (frame.objects) {
      json["objects"] = ordered_json::array();
      for (std::size_t i = 0; i < frame.objects->size(); ++i)
        json["objects"].push_back(
            object_json((*frame.objects)[i], i < scene.shapes.size() ? scene.shapes[i] : ""));
    }
    json_["frames"].push_back(std::move(json));
  }

  fs::path folder_;
  std::optional<double> fov_;
  ordered_json json_;
};

}  // namespace

SceneFormat recording_format() {
  return {.name = "recording",
          .about = "a folder of pictures with their cameras in poses.json",
          .settings = cutting_help(),
          .write_settings = {},
          .fields = {},
          .recognises =
              [](const fs::path& path) {
                std::error_code failed;
                return fs::is_regular_file(path / kPoses, failed);
              },
          .open = [](const fs::path& path, const FormatOptions& options) -> std::unique_ptr<SceneReader> {
            const Recording recording(path);
            std::vector<Film> films = recording.films(cutting(options));
            if (films.empty()) throw Error(fmt::format("{}: less than three frames", (path / kPoses).string()));
            return std::make_unique<FilmReader>(std::move(films), recording.fov());
          },
          .create = [](const fs::path& path, const FormatOptions&) -> std::unique_ptr<SceneWriter> {
            return std::make_unique<RecordingWriter>(path);
          }};
}

}  // namespace vkopple
