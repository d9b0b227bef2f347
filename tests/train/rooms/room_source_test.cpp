#include "train/rooms/room_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "runtime/transfer.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"
#include "train/model_store.h"
#include "train/step_batch.h"
#include "train/step_record.h"
#include "train/training_step.h"

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

TEST(RoomSource, YawIsThatSeenFromTheCamera) {
  RoomsConfig rooms;
  rooms.frames = 3;
  RoomSource source(test_device(), kLens, rooms, 1, 8);
  const TripletBatch b = source.read(2);
  const Scene scene = sample_scene(rooms, kLens.half_view(), 8, 2);
  const double turn = scene.cameras[1].yaw;
  ASSERT_NE(turn, 0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(b.objects[0][k].yaw, scene.objects[k].yaw(1) - turn);
}

TEST(RoomSource, FramesAreEvenlyStridedAndAllStridesComeUp) {
  RoomsConfig rooms;
  rooms.camera_step = 0;
  rooms.pan = 0;
  rooms.frames = 5;
  rooms.supersample = 1;
  RoomSource source(test_device(), Lens(8, 8, 1.3), rooms, 20, 1);
  const TripletBatch b = source.read(0);
  EXPECT_EQ(b.poses[0], b.poses[2]);  // the camera rests; only objects move
  EXPECT_NE(b.images[0], b.images[1]);
  EXPECT_NE(b.images[1], b.images[2]);
}

/// Triplet `b` of one frame.
template <class T>
std::vector<T> element(const std::vector<T>& all, std::size_t b, std::size_t batch) {
  const auto size = static_cast<std::ptrdiff_t>(all.size() / batch),
             begin = static_cast<std::ptrdiff_t>(b) * size;
  return {all.begin() + begin, all.begin() + begin + size};
}

TEST(RoomSource, TrainingSeesThePicturesThatAreRead) {
  for (const int first : {0, 1}) {
    RoomSource source(test_device(), kLens, RoomsConfig{}, 3, 42);
    const TripletBatch read = source.read(5), shown = source.show(5, {false, true, false}, first);
    const auto drawn = download_values<float>(test_device(), shown.drawn);
    const std::size_t frame_size = 9 * kLens.pixels(), frames = 3 - static_cast<std::size_t>(first);
    ASSERT_EQ(drawn.size(), frames * frame_size);
    for (std::size_t frame = static_cast<std::size_t>(first); frame < 3; ++frame) {
      const auto begin = drawn.begin() + static_cast<std::ptrdiff_t>((frame - 3 + frames) * frame_size);
      const std::vector<float> images(begin, begin + static_cast<std::ptrdiff_t>(frame_size));
      for (std::size_t b = 0; b < 3; ++b) {
        const std::size_t from = b == 1 ? 2 - frame : frame;
        EXPECT_EQ(element(images, b, 3), element(read.images[from], b, 3)) << "frame " << frame << " of " << b;
        EXPECT_EQ(element(shown.poses[frame], b, 3), element(read.poses[from], b, 3));
      }
    }
    EXPECT_TRUE(shown.depth.empty() && shown.label.empty() && shown.objects.empty());
  }
}

TEST(RoomSource, AModelLearnsTheSameFromPicturesLeftOnTheDevice) {
  const Config config = test::tiny_config();
  for (const TrainingStage& stage : config.stages()) {
    RoomSource source(test_device(), Lens(config.model), stage.rooms, stage.batch, 42);
    std::vector<Losses> losses;
    for (const bool on_device : {true, false}) {
      ModelStore store(test_device(), config.model, config.training.precision);
      store.initialise(1);
      TrainingStep training(test_device(), config, stage, store.groups());
      const int first = training.model().first_frame();
      EXPECT_EQ(first, stage.name == "depth" ? 1 : 0);
      Triplets triplets = training_triplets(source, 9, 0, stage.batch, 0.5, first);
      ASSERT_TRUE(triplets.drawn);
      if (!on_device) {
        auto reversed = reversed_triplets(9, 0, stage.batch, 0.5);
        triplets = model_triplets(source.TripletSource::show(0, reversed, first), triplets.permutation);
        ASSERT_FALSE(triplets.drawn);
      }
      losses.push_back(training.run(triplets, 1, 0));
    }
    EXPECT_EQ(losses[0], losses[1]) << stage.name;
  }
}

}  // namespace
}  // namespace vkopple
