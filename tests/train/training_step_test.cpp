#include "train/training_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
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

  Losses run(TrainingStep& training) { return training.run(shown(training), 1, 0); }
  TripletsOfPortion shown(TrainingStep& training) {
    const auto rooms = std::make_shared<RoomSource>(test_device(), Lens(config_.model), stage_.rooms,
                                                    static_cast<int>(training.batch()), 1);
    return [this, &training, rooms](int portion) {
      return training_triplets(*rooms, 1, 0, stage_.batch, 0.5, training.model().first_frame(), {},
                               {static_cast<uint64_t>(portion), static_cast<uint64_t>(stage_.accumulate)});
    };
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

TEST_F(TrainingStepTest, WhatIsNotFiniteIsSkippedAndChangesNothing) {
  TrainingStep training = make();
  const auto everything = [&] {
    std::vector<std::vector<float>> all;
    for (const auto* entries : {&store_.layout().weights(), &store_.layout().optimiser()})
      for (const LayoutEntry& entry : *entries) all.push_back(store_.read(entry));
    return all;
  };
  run(training);
  EXPECT_FALSE(training.skipped());
  EXPECT_EQ(training.executor().find_not_finite(), std::nullopt);
  // A bias of the object network that is no number, in the very network where it is found first.
  const auto& weights = store_.layout().weights();
  const auto bias = std::find_if(weights.begin(), weights.end(), [](const LayoutEntry& e) {
    return e.name.ends_with(".bias") && e.name.find("seg_net") != std::string::npos;
  });
  ASSERT_NE(bias, weights.end());
  const auto good = store_.read(*bias);
  store_.write(*bias, std::vector<float>(good.size(), std::numeric_limits<float>::infinity()));
  const auto before = everything();
  run(training);
  EXPECT_TRUE(training.skipped());
  EXPECT_EQ(everything(), before);
  const std::string why = training.diagnosis(shown(training), 1, 0);
  EXPECT_NE(why.find("not finite was "), std::string::npos) << why;
  EXPECT_NE(why.find("object"), std::string::npos) << why;
  EXPECT_NE(why.find(" in forward"), std::string::npos) << why;
  EXPECT_EQ(everything(), before);
  store_.write(*bias, good);
  run(training);
  EXPECT_FALSE(training.skipped());
  EXPECT_NE(everything(), before);
}

}  // namespace
}  // namespace vkopple
