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

}  // namespace
}  // namespace vkopple
