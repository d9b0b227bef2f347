#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "train/formats/camera_axes.h"
#include "train/formats/example_scenes.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

// Kubric's MOVi films (MOVi-E and its siblings) as TensorFlow Datasets flattens them: Blender's cameras in a
// world with z up.

const std::vector<UsualFeature> kFeatures{
    {"image", "video", "a PNG for each frame"},
    {"mask", "segmentations", "a PNG of 8 bits for each frame: 0 background, i + 1 instance i", false},
    {"depth", "depth", "a PNG of 16 bits for each frame: Euclidean distance over the range", false},
    {"depth_range", "metadata/depth_range", "2 floats: what 0 and 65535 stand for", false},
    {"position", "camera/positions", "3 floats for each frame"},
    {"quaternion", "camera/quaternions", "4 floats for each frame: w, x, y, z"},
    {"fov", "camera/field_of_view", "a float: radians; without it 0.8576", false},
    {"object", "instances/positions", "3 floats for each frame of each instance", false},
    {"object_turn", "instances/quaternions", "4 floats for each frame of each instance: w, x, y, z", false}};

constexpr double kHalfSensor = 16, kFocal = 35;  // millimetres, of a camera whose angle of view isn't told

template <std::size_t N>
std::array<double, N> numbers(std::span<const float> values, std::size_t index) {
  std::array<double, N> out{};
  for (std::size_t i = 0; i < N; ++i) out[i] = values[N * index + i];
  return out;
}

std::array<double, 3> scaled(std::array<double, 3> point, double scale) {
  for (double& x : point) x *= scale;
  return point;
}

/// Which way an object's own x axis points, seen from above.
double heading(const std::array<double, 4>& q) {
  return std::atan2(2 * (q[1] * q[2] + q[0] * q[3]), q[0] * q[0] + q[1] * q[1] - q[2] * q[2] - q[3] * q[3]);
}

/// One film on its way into a scene.
class FilmExample {
 public:
  FilmExample(const Example& example, const FeatureNames& names, double scale)
      : example_(example), names_(names), scale_(scale) {}

  SceneData read() {
    scene_.scale = scale_;
    scene_.frames = decode_frames(example_, names_["image"]);
    if (scene_.frames.empty()) return std::move(scene_);
    read_fov();
    read_cameras();
    if (names_.has("mask")) read_masks();
    if (names_.has("depth") && names_.has("depth_range")) read_depths();
    if (names_.has("object")) read_objects();
    return std::move(scene_);
  }

 private:
  std::size_t frames() const { return scene_.frames.size(); }
  std::string where(const std::string& ours, std::size_t index) const {
    return place_of(example_, names_[ours], index);
  }

  /// Theirs is horizontal.
  void read_fov() {
    const RgbImage& image = scene_.frames[0].image;
    const double half =
        names_.has("fov") ? std::tan(example_.floats(names_["fov"], 1)[0] / 2.0) : kHalfSensor / kFocal;
    scene_.fov = 2 * std::atan(half * image.height / image.width);
  }

  void read_cameras() {
    const auto positions = example_.floats(names_["position"], 3 * frames());
    const auto quaternions = example_.floats(names_["quaternion"], 4 * frames());
    for (std::size_t i = 0; i < frames(); ++i)
      scene_.frames[i].camera = made_at(where("quaternion", i), [&] {
        return own_pose(scaled(numbers<3>(positions, i), scale_), numbers<4>(quaternions, i),
                        CameraAxes::kGraphics, WorldAxes::kZUp);
      });
  }

  void read_masks() {
    const auto masks = example_.bytes(names_["mask"], frames());
    for (std::size_t i = 0; i < frames(); ++i) {
      const std::string place = where("mask", i);
      const auto mask = fitting(decode_grey<std::uint8_t>(as_bytes(masks[i]), place), scene_.frames, place);
      Plane<std::uint32_t>& ids = scene_.frames[i].ids;
      ids = {mask.height, mask.width};
      ids.pixels.assign(mask.pixels.begin(), mask.pixels.end());
    }
  }

  void read_depths() {
    const auto range = numbers<2>(example_.floats(names_["depth_range"], 2), 0);
    const auto depths = example_.bytes(names_["depth"], frames());
    for (std::size_t i = 0; i < frames(); ++i) {
      const std::string place = where("depth", i);
      const auto stored = fitting(decode_grey<std::uint16_t>(as_bytes(depths[i]), place), scene_.frames, place);
      Plane<float>& depth = scene_.frames[i].depth;
      depth = {stored.height, stored.width};
      for (std::size_t p = 0; p < depth.pixels.size(); ++p)
        depth.pixels[p] =
            static_cast<float>(scale_ * (range[0] + stored.pixels[p] / 65535.0 * (range[1] - range[0])));
    }
  }

  void read_objects() {
    const auto positions = example_.floats(names_["object"]);
    const std::size_t of_one = 3 * frames(), count = of_one == 0 ? 0 : positions.size() / of_one;
    if (positions.size() != count * of_one)
      throw Error(fmt::format("{} has {} values, not 3 for each of {} frames of each instance",
                              example_.where(names_["object"]), positions.size(), frames()));
    std::span<const float> quaternions;
    if (names_.has("object_turn")) quaternions = example_.floats(names_["object_turn"], count * 4 * frames());
    for (std::size_t i = 0; i < frames(); ++i) {
      auto& objects = scene_.frames[i].objects.emplace();
      for (std::size_t k = 0; k < count; ++k) {
        PlacedObject object{scaled(numbers<3>(positions, k * frames() + i), scale_), std::nullopt};
        if (!quaternions.empty()) object.yaw = heading(numbers<4>(quaternions, k * frames() + i));
        objects.push_back(object);
      }
    }
  }

  const Example& example_;
  const FeatureNames& names_;
  double scale_;
  SceneData scene_;
};

}  // namespace

SceneFormat movi_format() {
  return {.name = "movi",
          .about = "films of Kubric, MOVi-E and its siblings: TFRecord files of TensorFlow Datasets",
          .settings = {{"scale", "our units in a metre, by default 0.4"}},
          .write_settings = {},
          .fields = field_help(kFeatures),
          .recognises =
              [](const std::filesystem::path& path) {
                return first_example_has(path, {"video", "camera/positions", "camera/quaternions"});
              },
          .open = [](const std::filesystem::path& path,
                     const FormatOptions& options) -> std::unique_ptr<SceneReader> {
            // MOVi-E's cameras stand 8 to 12 m from the middle: half of what the model's depth reaches.
            const double scale = options.number("scale", 1e-3, 1e3, 0.4);
            return std::make_unique<ExampleScenes>(path, FeatureNames(kFeatures, options),
                                                   [=](const Example& example, const FeatureNames& names) {
                                                     return FilmExample(example, names, scale).read();
                                                   });
          }};
}

}  // namespace vkopple
