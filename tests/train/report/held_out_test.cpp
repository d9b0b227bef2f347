#include "train/report/held_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"
#include "train/metrics.h"
#include "train/model_store.h"
#include "train/rooms/room_source.h"

namespace vkopple {
namespace {

constexpr int kBatch = 2;
constexpr int64_t kImages = 5;
constexpr HeldOutLimits kLimits{.rows = 3, .yaws = 3, .triplets = 3};

/// What a model with drawn weights, such as see objects, sees in five rooms.
class HeldOutTest : public testing::Test {
 protected:
  HeldOutTest()
      : config_(test::tiny_config()), rooms_(test_device(), Lens(config_.model), config_.rooms, kBatch, 5) {
    ModelStore store(test_device(), config_.model);
    store.initialise(2);
    Perception perception(test_device(), config_.model, store.groups(), {.batch = kBatch});
    seen_ = look_at_held_out(perception, rooms_, kImages, kLimits, [&](int64_t done) { done_ = done; });
  }

  Config config_;
  RoomSource rooms_;
  HeldOut seen_;
  int64_t done_ = 0;
};

TEST_F(HeldOutTest, KeepsAsMuchAsItShould) {
  EXPECT_EQ(seen_.scores.images(), kImages);
  EXPECT_EQ(done_, kImages);
  EXPECT_EQ(seen_.grid.size(), kLimits.rows);
  EXPECT_EQ(seen_.from_above.size(), kLimits.rows);
  EXPECT_EQ(seen_.triplets.size(), kLimits.triplets);
  EXPECT_EQ(seen_.yaws.size(), kLimits.yaws);
}

TEST_F(HeldOutTest, TripletsAreTheFirstOfTheSource) {
  const TripletBatch first = rooms_.read(0), second = rooms_.read(1);
  for (size_t f = 0; f < 3; ++f) {
    const auto begin = first.images[f].begin(), middle = begin + 3 * 16 * 16;
    EXPECT_EQ(seen_.triplets[0].frames[f].pixels, std::vector<float>(begin, middle));
    EXPECT_EQ(seen_.triplets[1].frames[f].pixels, std::vector<float>(middle, first.images[f].end()));
    for (size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(seen_.triplets[1].poses[f][i], first.poses[f][6 + i]);
      EXPECT_EQ(seen_.triplets[2].poses[f][i], second.poses[f][i]);
    }
  }
}

TEST_F(HeldOutTest, MatchedObjectsAreThoseThatAreScored) {
  ASSERT_GT(seen_.matched.size(), 3U);
  Correlation angle, distance;
  for (const auto& [truth, inferred, iou] : seen_.matched) {
    angle.add(truth.angle(), inferred.angle());
    distance.add(truth.distance(), inferred.distance());
  }
  EXPECT_EQ(angle.r(), seen_.scores.angle_r());
  EXPECT_EQ(distance.r(), seen_.scores.distance_r());
}

TEST_F(HeldOutTest, FromAboveAreAllSlotsAndAllObjectsInSight) {
  for (size_t image = 0; image < kLimits.rows; ++image) {
    const std::vector<ObjectTruth> objects = rooms_.read(image / kBatch).objects[image % kBatch];
    std::ptrdiff_t true_places = 0, slots = 0;
    for (const PlacedPair& pair : seen_.from_above[image]) {
      slots += pair.inferred.has_value();
      if (!pair.truth) continue;
      ++true_places;
      EXPECT_TRUE(std::any_of(objects.begin(), objects.end(), [&](const ObjectTruth& o) {
        return o.location[0] == pair.truth->x && o.location[1] == pair.truth->y;
      }));
    }
    EXPECT_EQ(slots, config_.model.slots);
    EXPECT_EQ(true_places,
              std::count_if(objects.begin(), objects.end(), [](const ObjectTruth& o) { return o.pixels > 0; }));
  }
}

TEST_F(HeldOutTest, YawsAreDistributionsOfTheFirstImages) {
  for (const SeenYaw& yaw : seen_.yaws) {
    ASSERT_LT(yaw.image, kLimits.rows);
    EXPECT_LT(yaw.slot, config_.model.slots);
    EXPECT_EQ(yaw.probabilities.size(), 12U);
    EXPECT_NEAR(std::accumulate(yaw.probabilities.begin(), yaw.probabilities.end(), 0.0), 1, 1e-5);
    const std::vector<ObjectTruth> objects = rooms_.read(yaw.image / kBatch).objects[yaw.image % kBatch];
    EXPECT_TRUE(
        std::any_of(objects.begin(), objects.end(), [&](const ObjectTruth& o) { return o.yaw == yaw.truth; }));
  }
}

}  // namespace
}  // namespace vkopple
