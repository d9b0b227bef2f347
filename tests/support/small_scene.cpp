#include "tests/support/small_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace vkopple::test {

std::vector<int> bytes_of(const RgbImage& image) {
  std::vector<int> bytes;
  for (const float value : image.pixels) bytes.push_back(static_cast<int>(std::lround(255 * value)));
  return bytes;
}

SceneData small_scene(int number, int frames) {
  constexpr int kHeight = 4, kWidth = 6;
  SceneData scene{
      .key = fmt::format("{:03}", number), .source = "made", .fov = 1.25, .shapes = {"cube", "torus"}};
  for (int i = 0; i < frames; ++i) {
    SceneFrame frame{.image = RgbImage(kHeight, kWidth)};
    for (std::size_t p = 0; p < frame.image.pixels.size(); ++p)
      frame.image.pixels[p] =
          static_cast<float>((p * 3 + static_cast<std::size_t>(number * 10 + i)) % 256) / 255;
    frame.camera = CameraPose{0.25 * i, 1.5 * number, 0.7, 0.1 * i, -0.05, 0.02};
    frame.depth = Plane<float>(kHeight, kWidth);
    frame.ids = Plane<std::uint32_t>(kHeight, kWidth);
    for (std::size_t p = 0; p < frame.depth.pixels.size(); ++p) {
      frame.depth.pixels[p] = static_cast<float>(p + static_cast<std::size_t>(i)) / 16;
      frame.ids.pixels[p] = static_cast<std::uint32_t>(p % 3);
    }
    frame.objects = {{{1.0, 2.0 + i, 0.3}, 0.5 * i}, {{-1.0, 3.0, 0.4}, 1.0}};
    scene.frames.push_back(std::move(frame));
  }
  return scene;
}

void expect_same(const SceneData& found, const SceneData& expected) {
  EXPECT_EQ(found.key, expected.key);
  EXPECT_EQ(found.fov, expected.fov);
  EXPECT_EQ(found.shapes, expected.shapes);
  ASSERT_EQ(found.frames.size(), expected.frames.size());
  for (std::size_t i = 0; i < found.frames.size(); ++i) {
    const SceneFrame &a = found.frames[i], &b = expected.frames[i];
    EXPECT_EQ(bytes_of(a.image), bytes_of(b.image)) << i;
    EXPECT_EQ(a.camera, b.camera) << i;
    EXPECT_EQ(a.depth.pixels, b.depth.pixels) << i;
    EXPECT_EQ(a.ids.pixels, b.ids.pixels) << i;
    ASSERT_EQ(a.objects.has_value(), b.objects.has_value()) << i;
    if (!a.objects) continue;
    ASSERT_EQ(a.objects->size(), b.objects->size()) << i;
    for (std::size_t k = 0; k < a.objects->size(); ++k) {
      EXPECT_EQ((*a.objects)[k].location, (*b.objects)[k].location) << i;
      EXPECT_EQ((*a.objects)[k].yaw, (*b.objects)[k].yaw) << i;
    }
  }
}

}  // namespace vkopple::test
