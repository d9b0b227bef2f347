#include "train/formats/fit_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect_error.h"
#include "tests/support/small_scene.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::expect_same;
using test::small_scene;

TEST(FittedScene, StaysAsItIsUnlessAsked) { expect_same(fitted(small_scene(1, 3), {}), small_scene(1, 3)); }

TEST(FittedScene, IsCroppedToTheRatioAndNotDistorted) {
  const SceneData scene = small_scene(1, 1);  // 6 x 4
  const SceneData square = fitted(scene, {.height = 4, .width = 4});
  EXPECT_EQ(square.fov, scene.fov) << "columns are cropped, rows are not";
  const SceneFrame &a = square.frames[0], &b = scene.frames[0];
  for (std::size_t y = 0; y < 4; ++y)
    for (std::size_t x = 0; x < 4; ++x) {
      EXPECT_FLOAT_EQ(a.image.pixels[4 * y + x], b.image.pixels[6 * y + x + 1]);
      EXPECT_EQ(a.ids.pixels[4 * y + x], b.ids.pixels[6 * y + x + 1]);
      EXPECT_EQ(a.depth.pixels[4 * y + x], b.depth.pixels[6 * y + x + 1]);
    }
  const SceneData wide = fitted(scene, {.height = 2, .width = 6});
  EXPECT_NEAR(std::tan(wide.fov / 2), std::tan(scene.fov / 2) / 2, 1e-12);
  EXPECT_FLOAT_EQ(wide.frames[0].image.pixels[0], b.image.pixels[6]);
}

TEST(FittedScene, IsCroppedToTheAngleOfView) {
  const SceneData scene = small_scene(1, 1);
  const double half = 2 * std::atan(std::tan(scene.fov / 2) / 2);
  const SceneData near = fitted(scene, {.fov = half});
  EXPECT_EQ(near.fov, half);
  EXPECT_EQ(near.frames[0].image.height, 2);
  EXPECT_EQ(near.frames[0].image.width, 3);
  const auto& colours = scene.frames[0].image.pixels;
  EXPECT_NEAR(near.frames[0].image.pixels[0], (colours[6 + 1] + colours[6 + 2]) / 2, 1e-6);
  EXPECT_EQ(fitted(scene, {.height = 8, .width = 8, .fov = half}).frames[0].depth.width, 8);
  expect_error([&] { fitted(scene, {.fov = 1.3}); }, {"made: ", "71.62 degrees", "74.48"});
  expect_error([&] { fitted(scene, {.height = 4, .width = 8, .fov = 1.25}); },
               {"6 x 4", "too narrow", "8 x 4"});
  EXPECT_EQ(fitted(scene, {.height = 4, .width = 8}).frames[0].image.width, 8) << "by cropping rows";
}

TEST(FittedScene, OneSideGivesTheOther) {
  EXPECT_EQ(fitted(small_scene(1, 1), {.height = 8}).frames[0].image.width, 12);
  EXPECT_EQ(fitted(small_scene(1, 1), {.width = 12}).frames[0].image.height, 8);
}

TEST(FittedScene, AWidthAloneKeepsTheAngleOfView) {
  constexpr double kFov = std::numbers::pi / 6;
  const SceneData scene{.key = "a", .fov = kFov, .frames = {{.image = RgbImage(376, 1241)}}};
  for (const SceneFit& fit : {SceneFit{.width = 64}, SceneFit{.width = 64, .fov = kFov}}) {
    const SceneData small = fitted(scene, fit);
    EXPECT_EQ(small.fov, kFov);
    EXPECT_EQ(small.frames[0].image.height, 20);
    EXPECT_EQ(small.frames[0].image.width, 64);
  }
  EXPECT_EQ(fitted(scene, {.width = 1}).frames[0].image.height, 1);
}

TEST(FittedScene, DepthWithGapsIsNotMixed) {
  SceneData scene = small_scene(1, 1);
  scene.frames[0].depth.pixels.assign(24, 2);
  EXPECT_EQ(fitted(scene, {.height = 2, .width = 3}).frames[0].depth.pixels, std::vector<float>(6, 2));
  scene.frames[0].depth.pixels[0] = 0;
  const SceneData half = fitted(scene, {.height = 2, .width = 3});
  for (const float z : half.frames[0].depth.pixels) EXPECT_TRUE(z == 0 || z == 2) << z;
}

TEST(FittedScene, LengthsAreScaled) {
  const SceneData scene = small_scene(1, 2), large = fitted(scene, {.scale = 3});
  const SceneFrame &a = large.frames[1], &b = scene.frames[1];
  for (std::size_t i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ((*a.camera)[i], (*b.camera)[i] * (i < 3 ? 3 : 1));
  EXPECT_EQ(a.depth.pixels[7], 3 * b.depth.pixels[7]);
  EXPECT_DOUBLE_EQ((*a.objects)[0].location[1], 3 * (*b.objects)[0].location[1]);
  EXPECT_EQ((*a.objects)[0].yaw, (*b.objects)[0].yaw);
  EXPECT_EQ(large.fov, scene.fov);
  EXPECT_DOUBLE_EQ(fitted(large, {.scale = 0.5}).scale, 1.5);
}

}  // namespace
}  // namespace vkopple
