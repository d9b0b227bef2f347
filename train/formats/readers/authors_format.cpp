#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/data/triplets.h"
#include "train/formats/authors/authors_pictures.h"
#include "train/formats/authors/authors_table.h"
#include "train/formats/inside.h"
#include "train/formats/scene_reader.h"
#include "train/image_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTable = "data_map.pickle";
constexpr const char* kImages = "Camera_Images";
constexpr double kFovDegrees = 90;

double depth_unit(const FormatOptions& options) { return options.number("depth_unit", 1e-9, 1e6, 1); }
double fov(const FormatOptions& options) { return options.degrees("fov", 1, 175, kFovDegrees); }

class AuthorsReader : public SceneReader {
 public:
  AuthorsReader(fs::path folder, const FormatOptions& options)
      : folder_(std::move(folder)),
        images_(options.text("images", kImages)),
        fov_(fov(options)),
        depth_unit_(depth_unit(options)) {
    if (fs::exists(folder_ / kTable))
      rows_ = read_authors_table(folder_ / kTable);
    else
      rows_ = read_authors_texts(folder_, static_cast<std::size_t>(options.integer(
                                              "frames", 1, static_cast<long>(kMostSceneFrames), 3)));
    if (rows_.empty())
      throw Error(fmt::format("{}: neither a {} with rows nor cam_pos_STEM.txt for a scene's frames",
                              quote(folder_.string(), 4096), kTable));
  }

  std::optional<SceneData> next() override {
    if (read_ == rows_.size()) return std::nullopt;
    const AuthorsRow& row = rows_[read_];
    SceneData scene{.key = fmt::format("{:06}", read_),
                    .source = fmt::format("{}: row {}", folder_.string(), read_),
                    .fov = fov_};
    for (std::size_t i = 0; i < row.stems.size(); ++i) {
      SceneFrame frame = read_frame(row.stems[i], scene.source);
      check_film_size(row.stems.size(), frame, scene.source);
      frame.camera = row.cameras[i];
      if (!row.objects.empty()) frame.objects = row.objects[i];
      scene.frames.push_back(std::move(frame));
    }
    scene.shapes = row.shapes;
    ++read_;
    return scene;
  }

  std::optional<std::uint64_t> count() const override { return rows_.size(); }

 private:
  SceneFrame read_frame(const std::string& stem, const std::string& row) const {
    if (stem.find('/') != std::string::npos)
      throw Error(fmt::format("{}: {} must be the beginning of a file's name", row, quote(stem)));
    SceneFrame frame;
    const auto image = find(stem + "_img.png", row);
    if (!image)
      throw Error(fmt::format(
          "{}: neither {} nor {} is there; name the folder of pictures by --format-option images=", row,
          (folder_ / images_ / (stem + "_img.png")).string(), images_ + stem + "_img.png"));
    frame.image = read_rgb(*image);
    if (const auto layer = find(stem + "_layer.png", row))
      frame.ids = labels_of_colours(read_rgb(*layer), layer->string());
    if (const auto depth = find(stem + "_id.png", row))
      frame.depth = depth_of_colours(read_rgb(*depth), depth_unit_);
    return frame;
  }

  /// Within the folder of pictures, or beside it with the folder's name in front.
  std::optional<fs::path> find(const std::string& name, const std::string& row) const {
    for (const fs::path& path : {inside(folder_ / images_, name, row), inside(folder_, images_ + name, row),
                                 inside(folder_, name, row)}) {
      std::error_code failed;
      if (fs::is_regular_file(path, failed)) return path;
    }
    return std::nullopt;
  }

  fs::path folder_;
  std::string images_;
  double fov_, depth_unit_;
  std::vector<AuthorsRow> rows_;
  std::size_t read_ = 0;
};

/// Pictures, and at the end the table with a row for every evenly strided triplet of every scene.
class AuthorsWriter : public SceneWriter {
 public:
  AuthorsWriter(fs::path folder, const FormatOptions& options)
      : folder_(std::move(folder)),
        images_(options.text("images", kImages)),
        fov_(fov(options)),
        depth_unit_(depth_unit(options)) {
    std::error_code failed;
    fs::create_directories(folder_ / images_, failed);
    if (failed)
      throw Error(
          fmt::format("{}: the folder cannot be made: {}", quote(folder_.string(), 4096), failed.message()));
    if (fs::exists(folder_ / kTable))
      throw Error(fmt::format("{} holds {} already; remove the old data set or choose another folder",
                              quote(folder_.string(), 4096), kTable));
  }

  void add(const SceneData& scene) override {
    check_fov(scene);
    for (std::size_t i = 0; i < scene.frames.size(); ++i) write_frame(scene, i);
    for (const std::array<int, 3>& triplet : strided_triplets(static_cast<int>(scene.frames.size()))) {
      AuthorsRow row;
      row.shapes = scene.shapes;
      for (const int index : triplet) {
        const SceneFrame& frame = scene.frames[static_cast<std::size_t>(index)];
        if (!frame.camera)
          throw Error(fmt::format("{}: frame {} has no camera pose, which the authors' format needs",
                                  one_line(scene.source, 4096), index));
        row.stems.push_back(stem(scene, static_cast<std::size_t>(index)));
        row.cameras.push_back(*frame.camera);
        if (frame.objects) row.objects.push_back(*frame.objects);
      }
      rows_.push_back(std::move(row));
    }
  }

  void finish() override {
    if (rows_.empty()) throw Error(fmt::format("{}: no scene has three frames", quote(folder_.string(), 4096)));
    write_file(folder_ / kTable, authors_table_pickle(rows_));
  }

 private:
  /// The files don't hold it, so nothing would tell those who read them.
  void check_fov(const SceneData& scene) const {
    constexpr double kDegree = std::numbers::pi / 180;
    if (std::abs(scene.fov - fov_) <= 1e-6) return;
    throw Error(fmt::format(
        "{}: its angle of view is {:.10g} degrees and the data set's {:.10g}; crop pictures by --fov, "
        "or say --to-option fov={:.10g}, which whoever reads the data set must be told",
        one_line(scene.source, 4096), scene.fov / kDegree, fov_ / kDegree, scene.fov / kDegree));
  }

  static std::string stem(const SceneData& scene, std::size_t frame) {
    return fmt::format("{}-{:03}", scene.key, frame);
  }

  void write_frame(const SceneData& scene, std::size_t index) const {
    const SceneFrame& frame = scene.frames[index];
    const std::string start = (folder_ / images_ / stem(scene, index)).string();
    write_png(start + "_img.png", frame.image);
    if (!frame.ids.pixels.empty())
      write_png(start + "_layer.png", colours_of_labels(frame.ids, one_line(scene.source, 4096)));
    if (!frame.depth.pixels.empty()) write_png(start + "_id.png", colours_of_depth(frame.depth, depth_unit_));
  }

  fs::path folder_;
  std::string images_;
  double fov_, depth_unit_;
  std::vector<AuthorsRow> rows_;
};

bool recognises(const fs::path& path) {
  std::error_code failed;
  if (fs::is_regular_file(path / kTable, failed)) return true;
  for (auto entry = fs::directory_iterator(path, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed))
    if (entry->path().filename().string().starts_with("cam_pos_")) return true;
  return false;
}

}  // namespace

SceneFormat authors_format() {
  const NamedHelp images{"images", fmt::format("the folder of pictures, {} unless given", kImages)};
  const NamedHelp angle{"fov", fmt::format("vertical angle of view in degrees, {} unless given", kFovDegrees)};
  const NamedHelp unit{"depth_unit", "scene units in one unit of the depth pictures, 1 unless given"};
  return {.name = "authors",
          .about = fmt::format("the authors' rooms: {}, or cam_pos_STEM.txt, and pictures", kTable),
          .settings = {images, angle, unit, {"frames", "of a scene, where there is no table: 3 unless given"}},
          .write_settings = {images, angle, unit},
          .fields = {},
          .recognises = recognises,
          .open = [](const fs::path& path, const FormatOptions& options) -> std::unique_ptr<SceneReader> {
            return std::make_unique<AuthorsReader>(path, options);
          },
          .create = [](const fs::path& path, const FormatOptions& options) -> std::unique_ptr<SceneWriter> {
            return std::make_unique<AuthorsWriter>(path, options);
          }};
}

}  // namespace vkopple
