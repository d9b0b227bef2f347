#include "train/training_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/test_device.h"
#include "train/model_store.h"
#include "train/rooms/room_source.h"
#include "train/step_batch.h"

namespace vkopple {
namespace {

/// A step of everything on two rooms.
class TrainingStepTest : public testing::Test {
 protected:
  void SetUp() override {
    store_.initialise(3);
    stage_.batch = 2;
  }

  Losses run(TrainingStep& training) {
    RoomSource rooms(test_device(), Lens(config_.model), stage_.rooms, stage_.batch, 1);
    return training.run(training_triplets(rooms, 1, 0, stage_.batch, 0.5, training.model().first_frame(), {}),
                        1, 0);
  }
  TrainingStep make() { return TrainingStep(test_device(), config_, stage_, store_.groups()); }

  Config config_ = Config::load("tiny");
  TrainingStage stage_ = config_.stages().back();
  ModelStore store_{test_device(), config_.model};
};

double norm(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += double{v} * double{v};
  return std::sqrt(sum);
}

TEST_F(TrainingStepTest, AStageMayWeighTheRegularisersItself) {
  stage_.learning_rate = 1e-12;  // so that both see the same weights
  TrainingStep whole = make();
  const Losses all = run(whole);
  stage_.reg = 0;
  TrainingStep without = make();
  const Losses image_alone = run(without);
  EXPECT_NEAR(image_alone.at("total"), image_alone.at("image"), 1e-4);
  EXPECT_NEAR(image_alone.at("image"), all.at("image"), 1e-3);
  EXPECT_GT(std::abs(all.at("total") - all.at("image")), 0.1);
}

TEST_F(TrainingStepTest, NormsAreThoseOfAllWeightsAndGradients) {
  TrainingStep training = make();
  run(training);
  const auto norms = training.norms();
  ASSERT_EQ(norms.size(), 3U);
  for (const auto& [network, of] : norms) {
    std::vector<float> weights, gradients;
    for (const auto& [group, members] : training.graph().parameters()) {
      if (group != network) continue;
      for (const GroupMember& member : members) {
        const Value value(training.graph(), member.value);
        const auto w = training.executor().read(value);
        const auto g = training.executor().read_gradient(value);
        weights.insert(weights.end(), w.begin(), w.end());
        gradients.insert(gradients.end(), g.begin(), g.end());
      }
    }
    EXPECT_NEAR(of.weights, norm(weights), 1e-6 * of.weights) << network;
    EXPECT_NEAR(of.gradient, norm(gradients), 1e-6 * of.gradient) << network;
    EXPECT_GT(of.gradient, 0) << network;
  }
}

TEST_F(TrainingStepTest, ARateOfZeroChangesNoWeight) {
  TrainingStep training = make();
  training.set_learning_rate(0);
  const auto before = training.norms();
  run(training);
  for (const auto& [network, of] : training.norms())
    EXPECT_EQ(of.weights, before.at(network).weights) << network;
  training.set_learning_rate(1e-3);
  run(training);
  for (const auto& [network, of] : training.norms())
    EXPECT_NE(of.weights, before.at(network).weights) << network;
}

}  // namespace
}  // namespace vkopple
