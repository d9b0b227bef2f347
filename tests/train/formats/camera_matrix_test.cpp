#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect_error.h"
#include "train/formats/camera_axes.h"

namespace vkopple {
namespace {

using Matrix3 = std::array<double, 9>;
constexpr double kPi = std::numbers::pi;

Matrix3 rotation_part(const CameraPose& pose) {
  const Matrix4 m = camera_to_world(pose);
  return {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
}

void expect_near(const Matrix3& a, const Matrix3& b, double tolerance) {
  for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "entry " << i;
}

TEST(CameraMatrix, UndoesTheModelsMatrix) {
  for (const double yaw : {-3.0, -1.2, 0.0, 0.4, 2.9}) {
    for (const double pitch : {-1.5, -0.3, 0.0, 0.8}) {
      for (const double roll : {-2.5, 0.0, 1.1}) {
        const CameraPose pose{1, -2, 3, yaw, pitch, roll};
        const CameraPose found =
            own_pose_of_matrix({1, -2, 3}, rotation_part(pose), CameraAxes::kOwn, WorldAxes::kZUp);
        for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], pose[i], 1e-12) << "number " << i;
      }
    }
  }
}

TEST(CameraMatrix, StraightUpAndDownKeepTheRotation) {
  for (const double pitch : {kPi / 2, -kPi / 2}) {
    const Matrix3 rotation = rotation_part({0, 0, 0, 0.7, pitch, 0.4});
    const CameraPose pose = own_pose_of_matrix({0, 0, 0}, rotation, CameraAxes::kOwn, WorldAxes::kZUp);
    EXPECT_EQ(pose[5], 0);
    expect_near(rotation_part(pose), rotation, 1e-9);
  }
}

TEST(CameraMatrix, OfOpenGlInAWorldWithYUp) {
  // Without rotation it looks along -z, which is our y.
  const Matrix3 one{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const CameraPose level = own_pose_of_matrix({1, 2, 3}, one, CameraAxes::kGraphics, WorldAxes::kYUp);
  const CameraPose expected{1, -3, 2, 0, 0, 0};
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(level[i], expected[i], 1e-12) << "number " << i;
  // Turned by 30 degrees about y, counter-clockwise seen from above: to the left.
  const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
  const CameraPose left = own_pose_of_matrix({0, 0, 0}, Matrix3{c, 0, s, 0, 1, 0, -s, 0, c},
                                             CameraAxes::kGraphics, WorldAxes::kYUp);
  EXPECT_NEAR(left[3], kPi / 6, 1e-12);
  EXPECT_NEAR(left[4], 0, 1e-12);
  EXPECT_NEAR(left[5], 0, 1e-12);
  // Turned about x by 20 degrees, from -z towards y: it looks up.
  const double d = std::cos(kPi / 9), t = std::sin(kPi / 9);
  const CameraPose up = own_pose_of_matrix({0, 0, 0}, Matrix3{1, 0, 0, 0, d, -t, 0, t, d},
                                           CameraAxes::kGraphics, WorldAxes::kYUp);
  EXPECT_NEAR(up[4], kPi / 9, 1e-12);
}

TEST(CameraMatrix, RefusesWhatIsNoRotation) {
  const auto refuse = [](const Matrix3& m) {
    test::expect_error(
        [&] {
          own_pose_of_matrix({0, 0, 0}, m, CameraAxes::kOwn, WorldAxes::kZUp);
        },
        {"no rotation"});
  };
  refuse({1, 0, 0, 0, 1, 0, 0, 0, -1});  // a mirror
  refuse({2, 0, 0, 0, 2, 0, 0, 0, 2});
  refuse({1, 0.1, 0, 0, 1, 0, 0, 0, 1});
  refuse({std::nan(""), 0, 0, 0, 1, 0, 0, 0, 1});
}

}  // namespace
}  // namespace vkopple
