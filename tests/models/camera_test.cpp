#include "models/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace vkopple {
namespace {

constexpr double kPi = std::numbers::pi;

std::array<double, 3> transformed(const Matrix4& m, std::array<double, 3> p) {
  std::array<double, 3> out{};
  for (size_t i = 0; i < 3; ++i)
    out[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
  return out;
}

void expect_near(const std::array<double, 3>& got, const std::array<double, 3>& want) {
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(got[i], want[i], 1e-12) << "component " << i;
}

TEST(CameraTest, YawTurnsLeft) {
  // Turned left by a quarter, "forward" points to the world's -x.
  expect_near(transformed(camera_to_world({1, 2, 3, kPi / 2, 0, 0}), {0, 1, 0}), {0, 2, 3});
}

TEST(CameraTest, PitchLiftsForwardAndRollTipsRight) {
  expect_near(transformed(camera_to_world({0, 0, 0, 0, kPi / 2, 0}), {0, 1, 0}), {0, 0, 1});
  expect_near(transformed(camera_to_world({0, 0, 0, 0, 0, kPi / 2}), {1, 0, 0}), {0, 0, -1});
}

TEST(CameraTest, RollActsFirstThenPitchThenYaw) {
  // Right rolls down; pitch lifts what points down to forward; yaw turns forward to the left.
  expect_near(transformed(camera_to_world({0, 0, 0, kPi / 2, kPi / 2, kPi / 2}), {1, 0, 0}), {-1, 0, 0});
}

TEST(CameraTest, RelativeMapsPointsFromOneCameraToTheOther) {
  const CameraPose a{0.3, -0.2, 0.7, 0.4, 0.1, -0.05};
  const CameraPose b{-0.1, 0.5, 0.6, -1.2, 0.02, 0.3};
  const std::array<double, 3> in_a{0.5, 2, -0.3};
  const auto world = transformed(camera_to_world(a), in_a);
  expect_near(transformed(camera_to_world(b), transformed(relative(a, b), in_a)), world);
}

TEST(CameraTest, EgoMotionIsInTheFirstCamerasHeading) {
  const auto m = ego_motion({0, 0, 0, kPi / 2, 0, 0}, {-1, 0.5, 0, kPi / 2 + 0.1, 0, 0});
  expect_near(m, {0.5, 1, 0.1});
}

TEST(CameraTest, TurnsAreWrapped) {
  EXPECT_NEAR(ego_motion({0, 0, 0, 3, 0, 0}, {0, 0, 0, -3, 0, 0})[2], 2 * kPi - 6, 1e-12);
  EXPECT_NEAR(ego_motion({0, 0, 0, -3, 0, 0}, {0, 0, 0, 3, 0, 0})[2], 6 - 2 * kPi, 1e-12);
}

TEST(CameraTest, TurnsInSpaceAreVectorsInTheFirstCamerasFrame) {
  // Turned left by a quarter, the world's -x is ahead; then b looks up by 0.3 and stands one ahead and two
  // higher.
  const auto m = spatial_ego_motion({0, 0, 1, kPi / 2, 0, 0}, {-1, 0, 3, kPi / 2, 0.3, 0});
  expect_near({m[0], m[1], m[2]}, {0, 1, 2});
  expect_near({m[3], m[4], m[5]}, {0.3, 0, 0});
  // No turn, one of hardly anything, and one by more than half a turn, which is a shorter one the other way.
  const auto yaw = [](double angle) { return spatial_ego_motion({}, {0, 0, 0, angle, 0, 0})[5]; };
  EXPECT_EQ(yaw(0), 0);
  EXPECT_NEAR(yaw(1e-9), 1e-9, 1e-15);
  EXPECT_NEAR(yaw(4), 4 - 2 * kPi, 1e-12);
}

TEST(CameraTest, EulerAnglesMakeTheirRotation) {
  for (const CameraPose& pose :
       {CameraPose{0, 0, 0, 0.4, -0.7, 1.2}, CameraPose{0, 0, 0, -3, 1.4, -2.5}, CameraPose{}}) {
    const Matrix4 m = camera_to_world(pose);
    expect_near(euler_angles({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}),
                {pose[3], pose[4], pose[5]});
  }
}

TEST(CameraTest, StraightUpAndDownAllTurningIsYaw) {
  for (const double up : {1.0, -1.0}) {
    const Matrix4 m = camera_to_world({0, 0, 0, 0.7, up * kPi / 2, 0.4});
    const auto angles = euler_angles({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]});
    expect_near(angles, {0.7 + up * 0.4, up * kPi / 2, 0});
    const Matrix4 again = camera_to_world({0, 0, 0, angles[0], angles[1], angles[2]});
    for (size_t i = 0; i < 16; ++i) EXPECT_NEAR(again[i], m[i], 1e-12) << "entry " << i;
  }
}

TEST(CameraTest, ResamplingIndicesAreWholeDegrees) {
  const auto degrees = [](double d) { return resampling_index(d * kPi / 180); };
  EXPECT_EQ(degrees(0), 180U);
  EXPECT_EQ(degrees(-180), 0U);
  EXPECT_EQ(degrees(180), 360U);
  EXPECT_EQ(degrees(10.4), 190U);
  EXPECT_EQ(degrees(10.6), 191U);
  EXPECT_EQ(degrees(-10.6), 169U);
}

}  // namespace
}  // namespace vkopple
