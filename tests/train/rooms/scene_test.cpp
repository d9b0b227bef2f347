#include "train/rooms/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "runtime/error.h"
#include "train/rooms/scene_pack.h"

namespace vkopple {
namespace {

constexpr double kHalfView = std::numbers::pi / 4;

double distance(const Vec3& a, const Vec3& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

TEST(RoomScene, NothingTouchesAnythingInAnyFrame) {
  const RoomsConfig config;
  for (std::uint64_t index = 0; index < 200; ++index) {
    const Scene scene = sample_scene(config, kHalfView, 5, index);
    ASSERT_EQ(scene.objects.size(), 3U);
    ASSERT_EQ(scene.cameras.size(), 7U);
    for (int frame = 0; frame < config.frames; ++frame) {
      const Vec3 eye = scene.cameras[static_cast<std::size_t>(frame)].position;
      for (const RoomObject& a : scene.objects) {
        const Vec3 at = a.position(frame);
        EXPECT_GE(a.size, config.size[0]);
        EXPECT_LE(a.size, config.size[1]);
        EXPECT_LT(std::max(std::abs(at[0]), std::abs(at[1])) + kFootprint * a.size, kRoomHalf);
        EXPECT_GT(distance(at, eye), kFootprint * a.size);
        EXPECT_LT(at[2] + a.solid.h, kRoomHeight);
        for (const RoomObject& b : scene.objects) {
          if (&a == &b) continue;
          EXPECT_GT(distance(at, b.position(frame)), kFootprint * (a.size + b.size));
        }
      }
      EXPECT_LT(std::max(std::abs(eye[0]), std::abs(eye[1])), kRoomHalf);
    }
  }
}

TEST(RoomScene, MotionIsConstantForObjectsAndSmallForTheCamera) {
  RoomsConfig config;
  config.camera_step = 0.05;
  const Scene scene = sample_scene(config, kHalfView, 1, 0);
  const RoomObject& object = scene.objects[0];
  for (int frame = 0; frame < 6; ++frame) {
    EXPECT_NEAR(object.position(frame + 1)[0] - object.position(frame)[0], object.velocity[0], 1e-12);
    EXPECT_NEAR(object.yaw(frame + 1) - object.yaw(frame), object.spin, 1e-12);
    const RoomCamera& a = scene.cameras[static_cast<std::size_t>(frame)];
    const RoomCamera& b = scene.cameras[static_cast<std::size_t>(frame) + 1];
    EXPECT_LE(std::abs(b.position[0] - a.position[0]), 0.05);
    EXPECT_LE(std::abs(b.yaw - a.yaw), config.pan);
    EXPECT_NE(a.yaw, b.yaw);
  }
}

TEST(RoomScene, ASceneIsAFunctionOfSeedAndNumber) {
  const RoomsConfig config;
  std::vector<float> a, again, other, other_seed;
  pack_view(sample_scene(config, kHalfView, 3, 9), 2, a);
  sample_scene(config, kHalfView, 3, 10);
  pack_view(sample_scene(config, kHalfView, 3, 9), 2, again);
  pack_view(sample_scene(config, kHalfView, 3, 10), 2, other);
  pack_view(sample_scene(config, kHalfView, 4, 9), 2, other_seed);
  EXPECT_EQ(a.size(), packed_view_size(3));
  EXPECT_EQ(a, again);
  EXPECT_NE(a, other);
  EXPECT_NE(a, other_seed);
}

TEST(RoomScene, EveryShapeAndPatternComesUp) {
  RoomsConfig config;
  std::set<RoomShape> shapes;
  std::set<int> patterns;
  for (std::uint64_t index = 0; index < 200; ++index) {
    const Scene scene = sample_scene(config, kHalfView, 0, index);
    for (const RoomObject& object : scene.objects) {
      shapes.insert(object.shape);
      patterns.insert(object.material.pattern);
    }
  }
  EXPECT_EQ(shapes.size(), kRoomShapeNames.size());
  EXPECT_EQ(patterns.size(), static_cast<std::size_t>(kPeriodicPatterns + kSmoothPatterns));
}

TEST(RoomScene, OptionsAreObeyed) {
  RoomsConfig config;
  config.shapes = {RoomShape::kTorus, RoomShape::kCone};
  config.textures = RoomTextures::kPeriodic;
  config.objects = 2;
  config.frames = 3;
  for (std::uint64_t index = 0; index < 50; ++index) {
    const Scene scene = sample_scene(config, kHalfView, 0, index);
    ASSERT_EQ(scene.objects.size(), 2U);
    ASSERT_EQ(scene.cameras.size(), 3U);
    for (const RoomObject& object : scene.objects) {
      EXPECT_TRUE(object.shape == RoomShape::kTorus || object.shape == RoomShape::kCone);
      EXPECT_LT(object.material.pattern, kPeriodicPatterns);
    }
    EXPECT_LT(scene.wall.pattern, kPeriodicPatterns);
  }
}

TEST(RoomScene, EachObjectKeepsToItsSector) {
  RoomsConfig config;
  config.sectors = true;
  config.frames = 3;
  config.speed = 0.25;
  for (std::uint64_t index = 0; index < 20; ++index) {
    const Scene scene = sample_scene(config, kHalfView, 0, index);
    std::set<int> taken;
    for (const RoomObject& object : scene.objects) {
      std::set<int> seen;
      for (int frame = 0; frame < 3; ++frame) {
        const Vec3 at = scene.cameras[static_cast<std::size_t>(frame)].see(object.position(frame));
        const double across = std::atan2(at[0], at[1]) / (0.9 * kHalfView);
        ASSERT_LT(std::abs(across), 1);
        seen.insert(across < -1.0 / 3 ? 0 : across < 1.0 / 3 ? 1 : 2);
      }
      EXPECT_EQ(seen.size(), 1U);
      taken.insert(seen.begin(), seen.end());
    }
    EXPECT_EQ(taken.size(), 3U);
  }
}

TEST(RoomScene, RoomContrastFadesTheRoomAndNothingElse) {
  RoomsConfig config;
  const Scene vivid = sample_scene(config, kHalfView, 3, 9);
  config.room_contrast = 0.25;
  const Scene faded = sample_scene(config, kHalfView, 3, 9);
  for (const auto surface : {&Scene::wall, &Scene::floor, &Scene::ceiling}) {
    const auto& a = (vivid.*surface).colours;
    const auto& b = (faded.*surface).colours;
    double most = 0;  // two colours that differ by less are drawn again
    for (std::size_t channel = 0; channel < 3; ++channel)
      most = std::max(most, std::abs(a[0][channel] - a[1][channel]));
    EXPECT_GE(most, 0.35);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(b[0][channel] - b[1][channel], 0.25 * (a[0][channel] - a[1][channel]), 1e-12);
      EXPECT_NEAR(b[0][channel] - b[2][channel], 0.25 * (a[0][channel] - a[2][channel]), 1e-12);
      EXPECT_NEAR(b[0][channel] + b[1][channel] + b[2][channel], a[0][channel] + a[1][channel] + a[2][channel],
                  1e-12);
    }
  }
  for (std::size_t i = 0; i < vivid.objects.size(); ++i) {
    EXPECT_EQ(faded.objects[i].material.colours, vivid.objects[i].material.colours);
    EXPECT_EQ(faded.objects[i].start, vivid.objects[i].start);
  }
}

TEST(RoomScene, NoSpaceIsAnError) {
  RoomsConfig config;
  config.objects = 8;
  config.size = {1, 1};
  EXPECT_THROW(sample_scene(config, kHalfView, 0, 0), Error);
}

TEST(RoomScene, CameraSeesForwardAlongY) {
  RoomCamera pose;
  pose.position = {1, 2, 3};
  pose.yaw = std::numbers::pi / 2;  // turned left: forward is -x of the world
  const Vec3 seen = pose.see({-4, 2, 3.5});
  EXPECT_NEAR(seen[0], 0, 1e-12);
  EXPECT_NEAR(seen[1], 5, 1e-12);
  EXPECT_NEAR(seen[2], 0.5, 1e-12);
  pose.yaw = 0;
  pose.pitch = 0.3;  // looking up
  EXPECT_LT(pose.see({1, 3, 3})[2], 0);
  pose.pitch = 0;
  pose.roll = 0.3;  // the right side goes down
  EXPECT_GT(pose.see({2, 2, 3})[2], 0);
}

}  // namespace
}  // namespace vkopple
