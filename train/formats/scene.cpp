#include "train/formats/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

bool in_bounds(double number) { return std::abs(number) <= kFarthest; }  // not a number: no

class SceneCheck {
 public:
  explicit SceneCheck(const SceneData& scene) : scene_(scene) {}

  void all() const {
    check_key();
    if (!(scene_.fov > 0 && scene_.fov < std::numbers::pi))
      fail(fmt::format("the angle of view is {} and must lie between 0 and pi", scene_.fov));
    if (!(scene_.scale > 0 && in_bounds(scene_.scale)))
      fail(fmt::format("the scale is {} and must lie between 0 and {}", scene_.scale, kFarthest));
    if (scene_.frames.empty()) fail("no frames");
    if (scene_.frames.size() > kMostSceneFrames)
      fail(fmt::format("{} frames are more than {}", scene_.frames.size(), kMostSceneFrames));
    for (std::size_t i = 0; i < scene_.frames.size(); ++i) check_frame(scene_.frames[i], i);
  }

 private:
  void check_key() const {
    const auto allowed = [](unsigned char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
    };
    if (scene_.key.empty() || scene_.key.size() > 80 ||
        !std::all_of(scene_.key.begin(), scene_.key.end(), allowed))
      fail(fmt::format("{} can't be a scene's key: up to 80 letters, digits, '-' and '_' can",
                       quote(scene_.key)));
  }

  void check_frame(const SceneFrame& frame, std::size_t index) const {
    const auto wrong = [&](const std::string& what) { fail(fmt::format("frame {}: {}", index, what)); };
    const int height = scene_.frames[0].image.height, width = scene_.frames[0].image.width;
    if (height <= 0 || width <= 0) wrong("the image has no pixels");
    const auto area = static_cast<std::size_t>(height) * static_cast<std::size_t>(width);
    const auto fits = [&](int h, int w, std::size_t values, std::size_t channels) {
      return h == height && w == width && values == channels * area;
    };
    if (!fits(frame.image.height, frame.image.width, frame.image.pixels.size(), 3))
      wrong(fmt::format("its size of {} x {} is not the first frame's, {} x {}", frame.image.width,
                        frame.image.height, width, height));
    if (!frame.depth.pixels.empty() &&
        !fits(frame.depth.height, frame.depth.width, frame.depth.pixels.size(), 1))
      wrong("depth and image differ in size");
    if (!frame.ids.pixels.empty() && !fits(frame.ids.height, frame.ids.width, frame.ids.pixels.size(), 1))
      wrong("labels and image differ in size");
    const auto in_range = [](float value) { return value >= 0 && value <= 1; };
    if (!std::all_of(frame.image.pixels.begin(), frame.image.pixels.end(), in_range))
      wrong("a colour is not between 0 and 1");
    if (!is_sound(frame.depth)) wrong(fmt::format("a depth is negative, not a number or over {}", kFarthest));
    if (frame.camera && !std::all_of(frame.camera->begin(), frame.camera->end(), in_bounds))
      wrong("the camera's pose is out of bounds");
    check_objects(frame, wrong);
  }

  template <class Wrong>
  void check_objects(const SceneFrame& frame, const Wrong& wrong) const {
    const std::size_t known = frame.objects ? frame.objects->size() : kMostSceneObjects;
    if (known > kMostSceneObjects) wrong(fmt::format("{} objects are more than {}", known, kMostSceneObjects));
    for (const std::uint32_t id : frame.ids.pixels)
      if (id > known) wrong(fmt::format("label {} has no object: there are {}", id, known));
    if (!frame.objects) return;
    for (const PlacedObject& object : *frame.objects)
      if (!std::all_of(object.location.begin(), object.location.end(), in_bounds) ||
          !in_bounds(object.yaw.value_or(0)))
        wrong("an object's place is out of bounds");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}: {}", one_line(scene_.source, 4096), what));
  }

  const SceneData& scene_;
};

}  // namespace

bool is_sound(const Plane<float>& depth) {
  return std::all_of(depth.pixels.begin(), depth.pixels.end(),
                     [](float z) { return z >= 0 && z <= static_cast<float>(kFarthest); });
}

void check_film_size(std::size_t frames, const SceneFrame& frame, const std::string& where) {
  constexpr std::size_t kMostPixelsOfFilm = std::size_t{1} << 26;
  const auto check = [&](const auto& picture) {
    const auto area = static_cast<std::size_t>(picture.height) * static_cast<std::size_t>(picture.width);
    if (area > kMostPixelsOfFilm / frames)
      throw Error(fmt::format("{}: {} frames of {} x {} pixels are too many; make them smaller or fewer",
                              one_line(where, 4096), frames, picture.width, picture.height));
  };
  check(frame.image);
  check(frame.depth);
  check(frame.ids);
}

void check_scene(const SceneData& scene) { SceneCheck(scene).all(); }

}  // namespace vkopple
