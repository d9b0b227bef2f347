#include "train/contrast/warp.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vkopple {
namespace {

/// Three pixels in a row, the middle one straight ahead; focal length 1.
const Lens kRow(1, 3, 2 * std::atan(0.5));

TEST(Warp, PixelsGoBackAlongTheirRays) {
  const std::vector<Vec3> points = back_project_pixels(kRow, std::vector<float>{2, 3, 4});
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(points[0][0], -2 * half, 1e-12);
  EXPECT_NEAR(points[0][1], 2 * half, 1e-12);
  EXPECT_EQ(points[1], (Vec3{0, 3, 0}));
  EXPECT_NEAR(points[2][0], 4 * half, 1e-12);
  const Lens column(3, 1, 2 * std::atan(1.5));
  const auto top = back_project_pixels(column, std::vector<float>{1, 1, 1})[0];
  EXPECT_NEAR(top[2], half, 1e-12) << "rows count downwards, z upwards";
}

TEST(Warp, AMapIsARotationAndAShift) {
  const Matrix4 map{0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1};
  EXPECT_EQ(map_point(map, {5, 6, 7}), (Vec3{-5, 7, 10}));
}

TEST(Warp, PointsBetweenPixelsLandOnBothAndWhatIsNearCountsMore) {
  // Colours 1, 2, 3 in red. The first pixel lands a quarter right of the left pixel; the second on the right
  // one, as does the third, two units farther away.
  const std::vector<float> image{1, 2, 3, 0, 0, 0, 0, 0, 0};
  const std::vector<Vec3> points{{-0.75, 1, 0}, {1, 1, 0}, {3, 3, 0}};
  const WarpedImage warped = splat_pixels(kRow, 1.0, image, points);
  EXPECT_NEAR(warped.total[0], 0.75, 1e-4);
  EXPECT_NEAR(warped.total[1], 0.25, 1e-4);
  EXPECT_NEAR(warped.total[2], 2, 1e-4);
  EXPECT_NEAR(warped.colour[0], 1, 1e-6);
  EXPECT_NEAR(warped.colour[1], 1, 1e-3);
  const double near = std::exp(-std::sqrt(2.0)), far = std::exp(-3 * std::sqrt(2.0));
  EXPECT_NEAR(warped.colour[2], (2 * near + 3 * far) / (near + far), 1e-6);
}

TEST(Warp, WhatIsBehindOrBesideThePictureIsLost) {
  const std::vector<float> image(9, 1.0F);
  const WarpedImage warped =
      splat_pixels(kRow, 1.0, image, std::vector<Vec3>{{0, -1, 0}, {1.5, 1, 0}, {0, 1, 9}});
  EXPECT_EQ(warped.total[0], 0);
  EXPECT_EQ(warped.total[1], 0);
  EXPECT_NEAR(warped.total[2], 0.5, 1e-4);
  EXPECT_EQ(warped.colour[0], 0);
  EXPECT_NEAR(warped.colour[2], 1, 1e-6);
}

}  // namespace
}  // namespace vkopple
