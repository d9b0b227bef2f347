#include "train/formats/quaternion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalf = 0.70710678118654752;  // √½

Matrix3 product(const Matrix3& a, const Matrix3& b) {
  Matrix3 out{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      for (size_t k = 0; k < 3; ++k) out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
  return out;
}

Matrix3 rotation_part(const CameraPose& pose) {
  const Matrix4 m = camera_to_world(pose);
  return {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
}

void expect_near(const Matrix3& a, const Matrix3& b, double tolerance = 1e-12) {
  for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "entry " << i;
}

/// The angles of a pose at the origin.
std::array<double, 3> angles(const Matrix3& rotation, CameraAxes axes = CameraAxes::kRightForwardUp) {
  const CameraPose pose = camera_pose({0, 0, 0}, rotation, axes);
  return {pose[3], pose[4], pose[5]};
}

TEST(Quaternion, TurnsAboutEachAxis) {
  expect_near(rotation_matrix({1, 0, 0, 0}), {1, 0, 0, 0, 1, 0, 0, 0, 1});
  expect_near(rotation_matrix({kHalf, kHalf, 0, 0}), {1, 0, 0, 0, 0, -1, 0, 1, 0});  // y to z
  expect_near(rotation_matrix({kHalf, 0, kHalf, 0}), {0, 0, 1, 0, 1, 0, -1, 0, 0});  // z to x
  expect_near(rotation_matrix({kHalf, 0, 0, kHalf}), {0, -1, 0, 1, 0, 0, 0, 0, 1});  // x to y
}

TEST(Quaternion, LengthAndSignChangeNothing) {
  const Matrix3 one = rotation_matrix({0.1, -0.7, 0.3, 0.5});
  expect_near(rotation_matrix({-0.1, 0.7, -0.3, -0.5}), one);
  expect_near(rotation_matrix({0.3, -2.1, 0.9, 1.5}), one);
  EXPECT_TRUE(is_rotation(one, 1e-12));
}

TEST(Quaternion, RefusesWhatIsNoRotation) {
  test::expect_error([] { rotation_matrix({0, 0, 0, 0}); }, {"quaternion"});
  test::expect_error([] { rotation_matrix({std::nan(""), 0, 0, 1}); }, {"quaternion"});
  EXPECT_FALSE(is_rotation({1, 0, 0, 0, 1, 0, 0, 0, -1}, 1e-3));  // a mirror
  EXPECT_FALSE(is_rotation({2, 0, 0, 0, 2, 0, 0, 0, 2}, 1e-3));
  EXPECT_FALSE(is_rotation({1, 0.1, 0, 0, 1, 0, 0, 0, 1}, 1e-3));
  EXPECT_FALSE(is_rotation({std::nan(""), 0, 0, 0, 1, 0, 0, 0, 1}, 1e-3));
}

TEST(CameraPoseOf, UndoesTheModelsMatrix) {
  for (const double yaw : {-3.0, -1.2, 0.0, 0.4, 2.9}) {
    for (const double pitch : {-1.5, -0.3, 0.0, 0.8}) {
      for (const double roll : {-2.5, 0.0, 1.1}) {
        const CameraPose pose{1, -2, 3, yaw, pitch, roll};
        const CameraPose found = camera_pose({1, -2, 3}, rotation_part(pose), CameraAxes::kRightForwardUp);
        for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], pose[i], 1e-12) << "number " << i;
      }
    }
  }
}

TEST(CameraPoseOf, StraightUpAndDownKeepTheRotation) {
  for (const double pitch : {kPi / 2, -kPi / 2}) {
    const Matrix3 rotation = rotation_part({0, 0, 0, 0.7, pitch, 0.4});
    const CameraPose pose = camera_pose({0, 0, 0}, rotation, CameraAxes::kRightForwardUp);
    EXPECT_EQ(pose[5], 0);
    EXPECT_NEAR(pose[4], pitch, 1e-9);
    expect_near(rotation_part(pose), rotation, 1e-9);
  }
}

TEST(CameraPoseOf, CamerasOfOthersLookTheSameWay) {
  // OpenGL's camera without rotation looks along −z: straight down, the top of its picture towards y.
  auto [yaw, pitch, roll] = angles({1, 0, 0, 0, 1, 0, 0, 0, 1}, CameraAxes::kRightUpBackward);
  EXPECT_NEAR(pitch, -kPi / 2, 1e-12);
  EXPECT_NEAR(yaw + roll, 0, 1e-12);
  // Raised by a right angle it looks along y, level.
  for (const double angle : angles(rotation_matrix({kHalf, kHalf, 0, 0}), CameraAxes::kRightUpBackward))
    EXPECT_NEAR(angle, 0, 1e-12);
  // OpenCV's looks along z: lowered by a right angle from straight up, along y.
  for (const double angle : angles(rotation_matrix({kHalf, -kHalf, 0, 0}), CameraAxes::kRightDownForward))
    EXPECT_NEAR(angle, 0, 1e-12);
  // Turned left by 30° about the world's z after that, in both.
  const Matrix3 left = rotation_matrix({std::cos(kPi / 12), 0, 0, std::sin(kPi / 12)});
  for (const auto& [first, axes] : {std::pair{Quaternion{kHalf, kHalf, 0, 0}, CameraAxes::kRightUpBackward},
                                    {Quaternion{kHalf, -kHalf, 0, 0}, CameraAxes::kRightDownForward}}) {
    const auto found = angles(product(left, rotation_matrix(first)), axes);
    EXPECT_NEAR(found[0], kPi / 6, 1e-12);
    EXPECT_NEAR(found[1], 0, 1e-12);
    EXPECT_NEAR(found[2], 0, 1e-12);
  }
}

}  // namespace
}  // namespace vkopple
