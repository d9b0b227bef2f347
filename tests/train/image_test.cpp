#include "train/image.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

Plane<float> plane(int height, int width, std::vector<float> pixels) {
  Plane<float> p(height, width);
  p.pixels = std::move(pixels);
  return p;
}

void expect_near(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-6) << i;
}

TEST(Resize, WholeAreas) { expect_near(resize(plane(2, 4, {1, 3, 5, 7, 1, 3, 5, 9}), 1, 2).pixels, {2, 6.5f}); }

TEST(Resize, PartialAreas) {
  expect_near(resize(plane(1, 3, {3, 6, 9}), 1, 2).pixels, {(3 + 0.5f * 6) / 1.5f, (0.5f * 6 + 9) / 1.5f});
  expect_near(resize(plane(3, 1, {3, 6, 9}), 2, 1).pixels, {4, 8});
}

TEST(Resize, GrowsLinearly) {
  expect_near(resize(plane(1, 2, {0, 4}), 1, 4).pixels, {0, 1, 3, 4});
  expect_near(resize(plane(1, 1, {5}), 2, 3).pixels, {5, 5, 5, 5, 5, 5});
}

TEST(Resize, KeepsConstantsAndMeans) {
  for (const int size : {1, 2, 3, 7, 13, 31, 64}) {
    const auto same = resize(plane(13, 31, std::vector<float>(13 * 31, 0.3f)), size, size);
    for (const float value : same.pixels) EXPECT_NEAR(value, 0.3f, 1e-6) << size;
  }
  std::vector<float> values(13 * 31);
  std::iota(values.begin(), values.end(), 0.0f);
  const auto small = resize(plane(13, 31, values), 5, 7);
  EXPECT_NEAR(std::accumulate(small.pixels.begin(), small.pixels.end(), 0.0) / 35, 201, 1e-3);
}

TEST(Resize, ColoursStayApart) {
  RgbImage image(2, 2);
  image.pixels = {1, 1, 1, 1, 0, 1, 0, 1, 0, 0, 0, 0};
  expect_near(resize(image, 1, 1).pixels, {1, 0.5f, 0});
}

TEST(Resize, NearestKeepsLabels) {
  Plane<std::uint32_t> labels(2, 4);
  labels.pixels = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(resize_nearest(labels, 1, 2).pixels, (std::vector<std::uint32_t>{6, 8}));
  EXPECT_EQ(resize_nearest(labels, 2, 8).pixels,
            (std::vector<std::uint32_t>{1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8}));
}

TEST(Resize, RefusesNoPixels) {
  test::expect_error([] { resize(Plane<float>(2, 2), 0, 2); }, {"2x2", "0x2"});
  test::expect_error([] { resize(RgbImage(), 1, 1); }, {"0x0"});
}

TEST(Resize, AWindowMayCutPixels) {
  RgbImage image(1, 4);
  image.pixels = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  expect_near(resize(image, {0, 0.5, 1, 3}, 1, 2).pixels,
              {(0.5f * 0 + 1) / 1.5f, (2 + 0.5f * 3) / 1.5f, (0.5f * 4 + 5) / 1.5f, (6 + 0.5f * 7) / 1.5f,
               (0.5f * 8 + 9) / 1.5f, (10 + 0.5f * 11) / 1.5f});
  expect_near(resize(image, {0, 1, 1, 2}, 1, 4).pixels,
              {0.75f, 1.25f, 1.75f, 2.25f, 4.75f, 5.25f, 5.75f, 6.25f, 8.75f, 9.25f, 9.75f, 10.25f});
  Plane<std::uint32_t> labels(1, 4);
  labels.pixels = {7, 8, 9, 3};
  EXPECT_EQ(resize_nearest(labels, {0, 1.5, 1, 2.5}, 1, 2).pixels, (std::vector<std::uint32_t>{9, 3}));
  for (const Window& outside :
       {Window{0, 2, 1, 3}, Window{-1, 0, 1, 1}, Window{0, 0, 1, 0}, Window{0, 0, 2, 1}})
    test::expect_error([&] { resize(image, outside, 1, 1); }, {"an image of 1x4"});
}

TEST(ResizeDepth, TakesTheNearestWhereSomeIsUnknown) {
  expect_near(resize_depth(plane(1, 4, {1, 3, 5, 7}), 1, 2).pixels, {2, 6});
  expect_near(resize_depth(plane(1, 4, {1, 3, 0, 7}), 1, 2).pixels, {3, 7});
}

}  // namespace
}  // namespace vkopple
