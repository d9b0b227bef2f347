#include "train/rooms/room_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/test_device.h"

namespace vkopple {
namespace {

const Lens kLens(24, 32, 1.3);

TEST(RoomSource, AStepIsTheSameWheneverAskedFor) {
  RoomSource source(test_device(), kLens, RoomsConfig{}, 2, 42);
  const TripletBatch a = source.read(7);
  const TripletBatch other = source.read(8);
  const TripletBatch again = source.read(7);
  EXPECT_EQ(a.images, again.images);
  EXPECT_EQ(a.poses, again.poses);
  EXPECT_EQ(a.depth, again.depth);
  EXPECT_EQ(a.label, again.label);
  EXPECT_NE(a.images, other.images);
  RoomSource other_seed(test_device(), kLens, RoomsConfig{}, 2, 43);
  EXPECT_NE(a.images, other_seed.read(7).images);
}

TEST(RoomSource, ScenesDependOnTheirNumberAlone) {
  RoomSource two(test_device(), kLens, RoomsConfig{}, 2, 42), one(test_device(), kLens, RoomsConfig{}, 1, 42);
  const TripletBatch pair = two.read(3), single = one.read(7);
  const std::size_t area = kLens.pixels();
  for (std::size_t i = 0; i < area; ++i) ASSERT_EQ(pair.depth[area + i], single.depth[i]);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(pair.poses[2][6 + i], single.poses[2][i]);
}

TEST(RoomSource, ShapesAndTruthFit) {
  RoomsConfig rooms;
  rooms.shapes = {RoomShape::kSphere};
  RoomSource source(test_device(), kLens, rooms, 3, 1);
  const TripletBatch b = source.read(0);
  const std::size_t area = kLens.pixels();
  EXPECT_EQ(b.batch, 3);
  EXPECT_EQ(b.height, 24);
  EXPECT_EQ(b.width, 32);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(b.images[frame].size(), 9 * area);
    EXPECT_EQ(b.poses[frame].size(), 18U);
  }
  ASSERT_EQ(b.depth.size(), 3 * area);
  ASSERT_EQ(b.objects.size(), 3U);
  int looked_at = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(b.objects[i].size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      const ObjectTruth& truth = b.objects[i][k];
      // The pixel at which its middle projects, if it shows it, sees it at less than its distance.
      const double column = kLens.focal() * truth.location[0] / truth.location[1] + 15.5;
      const double line = -kLens.focal() * truth.location[2] / truth.location[1] + 11.5;
      if (truth.location[1] < 0 || column < 0 || column > 31 || line < 0 || line > 23) continue;
      const std::size_t at = i * area + static_cast<std::size_t>(std::lround(line)) * 32 +
                             static_cast<std::size_t>(std::lround(column));
      if (b.label[at] != k + 1) continue;  // another one stands before it
      ++looked_at;
      EXPECT_GT(truth.pixels, 0U);
      const double far = std::hypot(truth.location[0], truth.location[1], truth.location[2]);
      EXPECT_LT(b.depth[at], far);
      EXPECT_GT(b.depth[at], far - 0.55);
    }
  }
  EXPECT_GE(looked_at, 4);
}

TEST(RoomSource, FramesAreEvenlyStridedAndAllStridesComeUp) {
  RoomsConfig rooms;
  rooms.camera_step = 0;
  rooms.pan = 0;
  rooms.frames = 5;
  rooms.supersample = 1;
  RoomSource source(test_device(), Lens(8, 8, 1.3), rooms, 20, 1);
  source.render(0);
  for (int frame = 0; frame < 3; ++frame) EXPECT_EQ(source.image(frame).bytes, 20U * 64 * 16);
  EXPECT_EQ(source.poses(0), source.poses(2));  // the camera rests; only objects move
  const TripletBatch b = source.download();
  EXPECT_NE(b.images[0], b.images[1]);
  EXPECT_NE(b.images[1], b.images[2]);
}

}  // namespace
}  // namespace vkopple
