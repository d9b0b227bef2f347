#include "train/pictures.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

/// Red is the pixel's number, green and blue are 0.
RgbImage numbered(int height, int width) {
  RgbImage image(height, width);
  for (size_t i = 0; i < image.pixels.size() / 3; ++i) image.pixels[i] = static_cast<float>(i);
  return image;
}

TEST(Pictures, SmallOnesAreEnlarged) {
  EXPECT_EQ(zoom_for(32), 4);
  EXPECT_EQ(zoom_for(100), 2);
  EXPECT_EQ(zoom_for(128), 1);
  EXPECT_EQ(zoom_for(4096), 1);
  const RgbImage large = enlarge(numbered(2, 3), 2);
  ASSERT_EQ(large.height, 4);
  ASSERT_EQ(large.width, 6);
  const std::vector<float> red(large.pixels.begin(), large.pixels.begin() + 24);
  EXPECT_EQ(red, (std::vector<float>{0, 0, 1, 1, 2, 2, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 3, 3, 4, 4, 5, 5}));
}

TEST(Pictures, AnOverlayTintsObjectsAndOutlinesThem) {
  RgbImage image(1, 4);
  std::fill(image.pixels.begin(), image.pixels.end(), 0.5F);
  const std::vector<int32_t> labels{2, 2, 0, 0};
  const RgbImage tinted = overlay(image, labels, 2);
  const auto pixel = [&](size_t i) {
    return std::array{tinted.pixels[i], tinted.pixels[4 + i], tinted.pixels[8 + i]};
  };
  EXPECT_NEAR(pixel(0)[0], 0.5, 1e-6);  // background stays
  EXPECT_EQ(pixel(1), (std::array{1.0F, 1.0F, 1.0F}));
  const auto colour = label_colour(0);
  for (size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(pixel(3)[c], 0.45 * 0.5 + 0.55 * static_cast<double>(colour[c]), 1e-6);
  // Enlarged, the outline stays a pixel wide.
  const RgbImage large = overlay(image, labels, 2, 3);
  EXPECT_EQ(std::count(large.pixels.begin(), large.pixels.begin() + 12, 1.0F), 1);
  test::expect_error([&] { overlay(image, std::vector<int32_t>{0}, 2); }, {"sizes"});
}

TEST(Pictures, NearIsBrighterThanFar) {
  Plane<float> depth(1, 3);
  depth.pixels = {0, 3, 9};
  const RgbImage picture = depth_picture(depth, 6);
  const auto light = [&](size_t i) {
    return picture.pixels[i] + picture.pixels[3 + i] + picture.pixels[6 + i];
  };
  EXPECT_GT(light(0), light(1));
  EXPECT_GT(light(1), light(2));
}

TEST(Pictures, AGridHasAPlaceForEach) {
  const RgbImage grid = picture_grid({{numbered(2, 3), numbered(2, 3)}, {numbered(2, 3), numbered(2, 3)}});
  ASSERT_EQ(grid.height, 2 * 6 + 4);
  ASSERT_EQ(grid.width, 2 * 7 + 4);
  const auto red = [&](size_t y, size_t x) { return grid.pixels[y * 18 + x]; };
  EXPECT_EQ(red(0, 0), 1);  // white between
  EXPECT_EQ(red(4, 5), 1);
  EXPECT_EQ(red(4, 6), 2);
  EXPECT_EQ(red(5, 4), 3);
  EXPECT_EQ(red(11, 13), 5);
  test::expect_error([] { picture_grid({}); }, {"grid"});
  test::expect_error([] { picture_grid({{RgbImage(1, 1), RgbImage(2, 1)}}); }, {"size"});
}

}  // namespace
}  // namespace vkopple
