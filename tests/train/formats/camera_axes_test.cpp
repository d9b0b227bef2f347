#include "train/formats/camera_axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect_error.h"
#include "train/random.h"

namespace vkopple {
namespace {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;

/// Rows of the rotation, by the textbook.
std::array<Vector, 3> matrix(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

Quaternion random_rotation(Random& random) {
  Quaternion q{};
  double length = 0;
  for (double& number : q) {
    number = 2 * random.uniform() - 1;
    length += number * number;
  }
  for (double& number : q) number /= std::sqrt(length);
  return q;
}

/// The same point as our camera sees it.
Vector own_camera(const Vector& p, CameraAxes axes) {
  switch (axes) {
    case CameraAxes::kOwn:
      return p;
    case CameraAxes::kOptical:
      return {p[0], p[2], -p[1]};
    case CameraAxes::kGraphics:
      return {p[0], -p[2], p[1]};
    case CameraAxes::kBody:
      return {-p[1], p[0], p[2]};
  }
  return {};
}

TEST(OwnPose, ShowsEveryPointWhereTheOthersShowIt) {
  Random random(1, 2);
  for (const auto& [camera_name, camera] : camera_axes_by_name()) {
    for (const auto& [world_name, world] : world_axes_by_name()) {
      for (int i = 0; i < 20; ++i) {
        const Quaternion q = random_rotation(random);
        const Vector place{random.uniform(), random.uniform(), random.uniform()};
        const Vector seen{random.uniform(), random.uniform(), random.uniform()};  // in their camera's frame
        Vector there = place;
        for (std::size_t row = 0; row < 3; ++row)
          for (std::size_t c = 0; c < 3; ++c) there[row] += matrix(q)[row][c] * seen[c];
        const Vector expected = to_own_world(there, world);
        const Matrix4 m = camera_to_world(own_pose(place, q, camera, world));
        const Vector own = own_camera(seen, camera);
        for (std::size_t row = 0; row < 3; ++row)
          EXPECT_NEAR(m[4 * row] * own[0] + m[4 * row + 1] * own[1] + m[4 * row + 2] * own[2] + m[4 * row + 3],
                      expected[row], 1e-12)
              << camera_name << " " << world_name;
      }
    }
  }
}

TEST(OwnPose, OfLevelCamerasIsYaw) {
  constexpr double kHalf = std::numbers::pi / 4;
  // An optical frame that looks along the world's x, z up: ours has turned right by a quarter.
  const CameraPose pose = own_pose({1, 2, 3}, {0.5, -0.5, 0.5, -0.5}, CameraAxes::kOptical, WorldAxes::kZUp);
  const CameraPose expected{1, 2, 3, -2 * kHalf, 0, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(pose[i], expected[i], 1e-12) << i;
  const CameraPose turned =
      own_pose({}, {std::cos(0.3), 0, 0, std::sin(0.3)}, CameraAxes::kOwn, WorldAxes::kZUp);
  EXPECT_NEAR(turned[3], 0.6, 1e-12);
}

TEST(OwnPose, LookingStraightUpKeepsItsTurn) {
  const double c = std::sqrt(0.5);
  const CameraPose pose = own_pose({}, {c, c, 0, 0}, CameraAxes::kOwn, WorldAxes::kZUp);
  EXPECT_NEAR(pose[4], std::numbers::pi / 2, 1e-7);
  EXPECT_NEAR(pose[3], 0, 1e-12);
  EXPECT_EQ(pose[5], 0);
}

TEST(OwnPose, RefusesWhatIsNoRotation) {
  for (const Quaternion& q :
       {Quaternion{0, 0, 0, 0}, Quaternion{2, 0, 0, 0}, Quaternion{std::nan(""), 0, 0, 1}})
    test::expect_error([&] { own_pose({}, q, CameraAxes::kOwn, WorldAxes::kZUp); }, {"no unit quaternion"});
  EXPECT_NEAR(own_pose({}, {0.999, 0, 0, 0.001}, CameraAxes::kOwn, WorldAxes::kZUp)[3],
              2 * std::atan(0.001 / 0.999), 1e-12);
}

TEST(ToOwnWorld, IsARotation) {
  for (const auto& [name, world] : world_axes_by_name()) {
    const Vector x = to_own_world({1, 0, 0}, world), y = to_own_world({0, 1, 0}, world),
                 z = to_own_world({0, 0, 1}, world);
    EXPECT_EQ(x[1] * y[2] - x[2] * y[1], z[0]) << name;
    EXPECT_EQ(x[2] * y[0] - x[0] * y[2], z[1]) << name;
    EXPECT_EQ(x[0] * y[1] - x[1] * y[0], z[2]) << name;
  }
  EXPECT_EQ(to_own_world({0, 1, 0}, WorldAxes::kYUp), (Vector{0, 0, 1}));
  EXPECT_EQ(to_own_world({0, -1, 0}, WorldAxes::kYDown), (Vector{0, 0, 1}));
}

TEST(PlanarToEuclidean, IsTheLengthOfTheRay) {
  Plane<float> depth(2, 4);
  std::fill(depth.pixels.begin(), depth.pixels.end(), 3.0F);
  depth.pixels[5] = 0;
  planar_to_euclidean(depth, std::numbers::pi / 2);  // focal length 1 pixel
  EXPECT_NEAR(depth.pixels[0], 3 * std::sqrt(1 + 1.5 * 1.5 + 0.5 * 0.5), 1e-6);
  EXPECT_NEAR(depth.pixels[1], 3 * std::sqrt(1 + 0.5 * 0.5 + 0.5 * 0.5), 1e-6);
  EXPECT_EQ(depth.pixels[0], depth.pixels[7]);
  EXPECT_EQ(depth.pixels[5], 0);
}

}  // namespace
}  // namespace vkopple
