#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "train/formats/camera_axes.h"
#include "train/formats/example_scenes.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

// The rooms of GQN as O3V's code renders and writes them: OpenGL's cameras in a world with y up.

const std::vector<UsualFeature> kFeatures{
    {"image", "frames", "a JPEG or PNG for each frame"},
    {"camera", "camera_matrices", "4 x 4 floats for each frame, row by row: OpenGL's camera to world, y up"},
    {"depth", "depths", "a float for each pixel of each frame: along the optical axis, 0 for sky", false},
    {"mask", "masks", "a PNG for each frame, black but for objects, each of a colour of its own", false}};

/// Numbers the colours of an episode's masks in the order in which they appear.
class ColourLabels {
 public:
  Plane<std::uint32_t> of(const RgbImage& mask, const std::string& where) {
    Plane<std::uint32_t> ids(mask.height, mask.width);
    const std::size_t area = ids.pixels.size();
    for (std::size_t i = 0; i < area; ++i) {
      ids.pixels[i] =
          label({byte(mask.pixels[i]), byte(mask.pixels[area + i]), byte(mask.pixels[2 * area + i])});
      // Blended colours, of antialiased masks or JPEG, would pass for hundreds of objects.
      if (labels_.size() > kMostColours)
        throw Error(
            fmt::format("{}: more than {} colours, which can't be an object each", where, kMostColours));
    }
    return ids;
  }

 private:
  using Colour = std::array<int, 3>;
  static constexpr std::size_t kMostColours = 64;

  static int byte(float value) { return static_cast<int>(std::lround(255 * value)); }

  std::uint32_t label(const Colour& colour) {
    if (colour == Colour{0, 0, 0}) return 0;
    return labels_.emplace(colour, static_cast<std::uint32_t>(labels_.size() + 1)).first->second;
  }

  std::map<Colour, std::uint32_t> labels_;
};

CameraPose pose(std::span<const float> m, double scale) {
  const std::array<double, 3> place{m[3] * scale, m[7] * scale, m[11] * scale};
  const std::array<double, 9> rotation{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
  return own_pose_of_matrix(place, rotation, CameraAxes::kGraphics, WorldAxes::kYUp);
}

Plane<float> euclidean_depth(std::span<const float> planar, int height, int width, double fov, double scale) {
  Plane<float> depth(height, width);
  std::transform(planar.begin(), planar.end(), depth.pixels.begin(),
                 [&](float z) { return static_cast<float>(z * scale); });
  planar_to_euclidean(depth, fov);
  return depth;
}

SceneData convert(const Example& example, const FeatureNames& names, double fov, double scale) {
  SceneData scene;
  scene.fov = fov;
  scene.scale = scale;
  scene.frames = decode_frames(example, names["image"]);
  const std::size_t frames = scene.frames.size();
  if (frames == 0) return scene;
  const int height = scene.frames[0].image.height, width = scene.frames[0].image.width;
  const std::size_t area = static_cast<std::size_t>(height) * static_cast<std::size_t>(width);

  const auto cameras = example.floats(names["camera"], 16 * frames);
  for (std::size_t i = 0; i < frames; ++i)
    scene.frames[i].camera = made_at(place_of(example, names["camera"], i),
                                     [&] { return pose(cameras.subspan(16 * i, 16), scale); });
  if (names.has("depth")) {
    const auto depths = example.floats(names["depth"], area * frames);
    for (std::size_t i = 0; i < frames; ++i)
      scene.frames[i].depth = euclidean_depth(depths.subspan(area * i, area), height, width, fov, scale);
  }
  if (names.has("mask")) {
    const auto masks = example.bytes(names["mask"], frames);
    ColourLabels labels;
    for (std::size_t i = 0; i < frames; ++i) {
      const std::string where = place_of(example, names["mask"], i);
      scene.frames[i].ids =
          labels.of(fitting(decode_png(as_bytes(masks[i]), where), scene.frames, where), where);
    }
  }
  return scene;
}

}  // namespace

SceneFormat gqn_format() {
  return {.name = "gqn",
          .about = "rooms of GQN as O3V renders them: TFRecord files, plain or of GZIP",
          .settings = {{"fov", "vertical angle of view in degrees, by default 45"},
                       {"scale", "our units in one of theirs, by default 0.7"}},
          .write_settings = {},
          .fields = field_help(kFeatures),
          .recognises =
              [](const std::filesystem::path& path) {
                return first_example_has(path, {"frames", "camera_matrices"});
              },
          .open = [](const std::filesystem::path& path,
                     const FormatOptions& options) -> std::unique_ptr<SceneReader> {
            const double fov = options.degrees("fov", 1, 179, 45);
            // The far wall, 10 units away at most, comes within the 7.2 units that the model's depth reaches.
            const double scale = options.number("scale", 1e-3, 1e3, 0.7);
            return std::make_unique<ExampleScenes>(path, FeatureNames(kFeatures, options),
                                                   [=](const Example& example, const FeatureNames& names) {
                                                     return convert(example, names, fov, scale);
                                                   });
          }};
}

}  // namespace vkopple
