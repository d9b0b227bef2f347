#include "train/formats/film_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/formats/camera_axes.h"
#include "train/image_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr long kFramesOfAFilm = 24;
constexpr std::size_t kFewestFrames = 3;
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;

Plane<float> read_planar_depth(const FilmFrame& listed, double fov) {
  const Plane<std::uint16_t> steps =
      decode_grey<std::uint16_t>(read_file(listed.planar_depth, kMaxFileBytes), listed.planar_depth.string());
  Plane<float> depth(steps.height, steps.width);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<float>(steps.pixels[i] * listed.depth_unit);
  planar_to_euclidean(depth, fov);
  return depth;
}

SceneFrame read_frame(const FilmFrame& listed, double fov) {
  SceneFrame frame{.image = read_rgb(listed.image), .camera = listed.camera};
  frame.objects = listed.objects;
  if (!listed.planar_depth.empty()) frame.depth = read_planar_depth(listed, fov);
  if (listed.layers.empty()) return frame;
  DepthAndIds layers = decode_exr(read_file(listed.layers, kMaxFileBytes), listed.layers.string());
  frame.depth = std::move(layers.depth);
  frame.ids = std::move(layers.ids);
  return frame;
}

}  // namespace

std::optional<SceneData> FilmReader::next() {
  if (read_ == films_.size()) return std::nullopt;
  const Film& film = films_[read_++];
  if (film.frames.size() > kMostSceneFrames)  // before they take memory
    throw Error(fmt::format("{}: the scene {} that begins with it has {} frames; at most {} are read",
                            film.frames[0].image.string(), quote(film.key), film.frames.size(),
                            kMostSceneFrames));
  SceneData scene{.key = film.key, .source = film.frames.at(0).image.string(), .fov = fov_};
  for (const FilmFrame& listed : film.frames) {
    scene.frames.push_back(read_frame(listed, fov_));
    check_film_size(film.frames.size(), scene.frames.back(), listed.image.string());
  }
  scene.shapes = film.shapes;
  return scene;
}

Cutting cutting(const FormatOptions& options) {
  return {options.integer("every", 1, 1'000'000, 1),
          options.integer("frames", 1, static_cast<long>(kMostSceneFrames), kFramesOfAFilm)};
}

std::vector<NamedHelp> cutting_help() {
  return {
      {"every", "of so many pictures one is taken, 1 unless given"},
      {"frames", fmt::format("of a scene, into which a recording is cut: {} unless given", kFramesOfAFilm)}};
}

std::vector<Film> cut_into_films(const std::vector<FilmFrame>& frames, const Cutting& cutting,
                                 std::size_t first) {
  std::vector<Film> films;
  Film film;
  const std::size_t fewest = std::min(kFewestFrames, static_cast<std::size_t>(cutting.frames));
  const auto close = [&] {
    if (film.frames.size() < fewest) return;
    film.key = fmt::format("{:06}", first + films.size());
    films.push_back(std::move(film));
    film = {};
  };
  for (std::size_t i = 0; i < frames.size(); i += static_cast<std::size_t>(cutting.every)) {
    film.frames.push_back(frames[i]);
    if (film.frames.size() == static_cast<std::size_t>(cutting.frames)) close();
  }
  close();
  return films;
}

}  // namespace vkopple
