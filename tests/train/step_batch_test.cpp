#include "train/step_batch.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vkopple {
namespace {

/// 1×1 pixels; every number of frame f of triplet i is 100 step + 10 i + f.
class NumberedTriplets : public TripletSource {
 public:
  explicit NumberedTriplets(int batch) : batch_(batch) {}
  TripletBatch read(uint64_t step) override {
    TripletBatch result{.batch = batch_, .height = 1, .width = 1};
    for (size_t frame = 0; frame < 3; ++frame) {
      for (int i = 0; i < batch_; ++i) {
        const auto number = static_cast<float>(100 * static_cast<int>(step) + 10 * i + static_cast<int>(frame));
        result.images[frame].insert(result.images[frame].end(), 3, number);
        result.poses[frame].insert(result.poses[frame].end(), 6, number);
      }
    }
    return result;
  }

 private:
  int batch_;
};

TEST(StepBatch, ReversalsFollowTheirProbability) {
  EXPECT_EQ(reversed_triplets(1, 2, 5, 0), std::vector<bool>(5, false));
  EXPECT_EQ(reversed_triplets(1, 2, 5, 1), std::vector<bool>(5, true));
  int reversed = 0;
  for (uint64_t step = 0; step < 100; ++step) {
    const auto now = reversed_triplets(7, step, 10, 0.3);
    EXPECT_EQ(now, reversed_triplets(7, step, 10, 0.3));
    reversed += static_cast<int>(std::count(now.begin(), now.end(), true));
  }
  EXPECT_NEAR(reversed, 300, 60);  // four standard deviations
}

TEST(StepBatch, PermutationsAreEveryOneAndAllDiffer) {
  std::vector<uint32_t> wanted{0, 1, 2, 3, 4, 5, 6, 7};
  auto order = scene_permutation(3, 4, 8);
  EXPECT_EQ(order, scene_permutation(3, 4, 8));
  EXPECT_NE(order, scene_permutation(3, 5, 8));
  EXPECT_NE(order, scene_permutation(4, 4, 8));
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, wanted);
  EXPECT_EQ(scene_permutation(3, 4, 1), std::vector<uint32_t>{0});
}

TEST(StepBatch, APortionsScenesFollowEachOtherAsInTheWhole) {
  const auto whole = scene_permutation(3, 4, 6);
  EXPECT_EQ(scene_permutation(3, 4, 6, {0, 1}), whole);
  for (uint32_t portion = 0; portion < 3; ++portion) {
    std::vector<uint32_t> wanted;
    for (const uint32_t scene : whole)
      if (scene / 2 == portion) wanted.push_back(scene % 2);
    EXPECT_EQ(scene_permutation(3, 4, 6, {portion, 3}), wanted) << portion;
  }
}

TEST(StepBatch, FramesFollowOneAnother) {
  NumberedTriplets source(2);
  const Triplets t = training_triplets(source, 1, 3, 2, 0);
  const std::vector<float> images{300, 300, 300, 310, 310, 310, 301, 301, 301,
                                  311, 311, 311, 302, 302, 302, 312, 312, 312};
  EXPECT_EQ(t.images, images);
  ASSERT_EQ(t.poses.size(), 6U);
  EXPECT_EQ(t.permutation.size(), 2U);
}

TEST(StepBatch, AReversedTripletIsReversedInImagesAndPoses) {
  NumberedTriplets source(1);
  const Triplets there = training_triplets(source, 1, 0, 1, 0), back = training_triplets(source, 1, 0, 1, 1);
  EXPECT_EQ(back.images, (std::vector<float>{2, 2, 2, 1, 1, 1, 0, 0, 0}));
  EXPECT_EQ(there.images, (std::vector<float>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
  EXPECT_EQ(there.poses[2], (CameraPose{2, 2, 2, 2, 2, 2}));
  EXPECT_EQ(back.poses[0], there.poses[2]);
  EXPECT_EQ(back.poses[1], there.poses[1]);
  EXPECT_EQ(back.poses[2], there.poses[0]);
}

}  // namespace
}  // namespace vkopple
