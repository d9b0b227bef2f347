#include <cmath>
#include <utility>

#include "train/formats/example_scenes.h"

namespace vkopple {
namespace {

// CLEVR with masks, of DeepMind's multi-object datasets: single images of which objects are known, neither
// camera nor depth.

constexpr int kHeight = 240, kWidth = 320, kChannels = 3, kEntities = 11;
// The crop that everybody scores: what most of the objects are in.
constexpr int kTop = 29, kBottom = 221, kLeft = 64, kRight = 256, kSize = 128;
constexpr int kCropHeight = kBottom - kTop, kCropWidth = kRight - kLeft;

const std::vector<UsualFeature> kFeatures{
    {"image", "image", "240 x 320 x 3 bytes, in one string or in one string each"},
    {"mask", "mask", "11 x 240 x 320 bytes likewise, above 0 where an entity is; the first is background"}};

std::size_t pixel(int row, int column) {
  return static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column);
}

/// Calls `take(index in the crop, index in the whole)` for every pixel of the crop.
template <class Take>
void each_cropped(const Take& take) {
  std::size_t to = 0;
  for (int row = kTop; row < kBottom; ++row)
    for (int column = kLeft; column < kRight; ++column) take(to++, pixel(row, column));
}

RgbImage cropped_image(const std::vector<std::uint8_t>& bytes) {
  RgbImage image(kCropHeight, kCropWidth);
  const std::size_t area = image.pixels.size() / kChannels;
  each_cropped([&](std::size_t to, std::size_t from) {
    for (std::size_t c = 0; c < kChannels; ++c)
      image.pixels[c * area + to] = static_cast<float>(bytes[kChannels * from + c]) / 255;
  });
  return image;
}

/// The entity whose mask is the largest; where all are 0, background.
Plane<std::uint32_t> cropped_labels(const std::vector<std::uint8_t>& masks) {
  Plane<std::uint32_t> ids(kCropHeight, kCropWidth);
  constexpr std::size_t kArea = std::size_t{kHeight} * kWidth;
  each_cropped([&](std::size_t to, std::size_t from) {
    std::size_t best = 0;
    for (std::size_t e = 1; e < kEntities; ++e)
      if (masks[e * kArea + from] > masks[best * kArea + from]) best = e;
    ids.pixels[to] = static_cast<std::uint32_t>(best);
  });
  return ids;
}

SceneData convert(const Example& example, const FeatureNames& names) {
  constexpr std::size_t kArea = std::size_t{kHeight} * kWidth;
  const auto image = example.joined(names["image"], kChannels * kArea);
  const auto masks = example.joined(names["mask"], kEntities * kArea);
  SceneData scene;
  // CLEVR's camera has a lens of 35 mm before a sensor 32 mm wide: 350 pixels.
  scene.fov = 2 * std::atan(kCropHeight / 2.0 / 350.0);
  scene.frames.push_back({.image = resize(cropped_image(image), kSize, kSize)});
  scene.frames[0].ids = resize_nearest(cropped_labels(masks), kSize, kSize);
  return scene;
}

}  // namespace

SceneFormat clevr_format() {
  return {.name = "clevr",
          .about = "CLEVR with masks, of the multi-object datasets: a TFRecord file of single images",
          .settings = {},
          .write_settings = {},
          .fields = field_help(kFeatures),
          .recognises =
              [](const std::filesystem::path& path) {
                return first_example_has(path, {"image", "mask", "pixel_coords"});
              },
          .open = [](const std::filesystem::path& path,
                     const FormatOptions& options) -> std::unique_ptr<SceneReader> {
            return std::make_unique<ExampleScenes>(path, FeatureNames(kFeatures, options), convert);
          }};
}

}  // namespace vkopple
