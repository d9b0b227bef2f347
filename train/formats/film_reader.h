#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "train/formats/scene_reader.h"

namespace vkopple {

/// A frame of a film of picture files.
struct FilmFrame {
  std::filesystem::path image;
  std::optional<CameraPose> camera;
  std::filesystem::path layers;        ///< EXR of depth and ids; empty: there is none
  std::filesystem::path planar_depth;  ///< grey PNG of 16 bits, distances along the optical axis; likewise
  double depth_unit = 1;               ///< scene units in one step of it
  std::optional<std::vector<PlacedObject>> objects;
};

/// A film of picture files, read when its turn comes.
struct Film {
  std::string key;
  std::vector<FilmFrame> frames;
  std::vector<std::string> shapes;
};

/// Films of one camera.
class FilmReader : public SceneReader {
 public:
  /// `fov`: vertical, radians.
  FilmReader(std::vector<Film> films, double fov) : films_(std::move(films)), fov_(fov) {}

  std::optional<SceneData> next() override;
  std::optional<std::uint64_t> count() const override { return films_.size(); }

 private:
  std::vector<Film> films_;
  double fov_;
  std::size_t read_ = 0;
};

/// How a long recording becomes films, for formats that have them.
struct Cutting {
  long every = 1;   ///< of so many pictures one is taken
  long frames = 0;  ///< of a film
};
/// The settings `every` and `frames`.
Cutting cutting(const FormatOptions& options);
std::vector<NamedHelp> cutting_help();

/// Cuts a recording into films with keys 000000, 000001, ...; `first` is how many came before. What is left at
/// the end is a film if it has three frames, and is dropped otherwise.
std::vector<Film> cut_into_films(const std::vector<FilmFrame>& frames, const Cutting& cutting,
                                 std::size_t first);

}  // namespace vkopple
