#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "runtime/device.h"
#include "runtime/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/relative_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/threaded_peers.h"
#include "train/atomic_file.h"
#include "train/data/open_source.h"
#include "train/model_store.h"
#include "train/safetensors.h"
#include "train/step_batch.h"
#include "train/trainer.h"
#include "train/training_step.h"

// Steps whose batch is worked off in portions, against their portions alone.

namespace vkopple {
namespace {

using test::expect_error;
using test::relative_error;

using Numbers = std::vector<float>;

constexpr uint64_t kSeed = 5;

/// Nothing is dropped, as portions drop other values than one would; nothing joins scenes.
Config config() {
  return Config::parse(
      R"({"model": {"height": 16, "width": 16, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
                    "imagine_width": 1, "lstm": 8, "dropout": [0, 0, 0], "reg": 0},
          "training": {"batch": 8}, "rooms": {"supersample": 1}})",
      "test");
}

/// A model that trains on rooms.
class Portioned {
 public:
  explicit Portioned(const Config& config, Peers* peers = nullptr, const Device& device = test_device())
      : config_(config), stage_(config.stages().front()), store_(device, config.model) {
    store_.initialise(kSeed);
    if (peers != nullptr) part_ = {static_cast<uint64_t>(peers->rank()), static_cast<uint64_t>(peers->count())};
    training_ = std::make_unique<TrainingStep>(device, config_, stage_, store_.groups(), false, peers);
    source_ = open_triplets(
        device, "rooms:3", Lens(config_.model), stage_.rooms, static_cast<int>(training_->batch()),
        {.seed = kSeed, .part = part_, .portions = static_cast<uint64_t>(stage_.accumulate)});
  }

  /// Of step 0.
  Triplets triplets(int portion) {
    return training_triplets(*source_, kSeed, 0, stage_.batch, 0.5, 0, part_,
                             {static_cast<uint64_t>(portion), static_cast<uint64_t>(stage_.accumulate)});
  }
  Losses step() {
    return training_->run([&](int portion) { return triplets(portion); }, 1, 0);
  }

  TrainingStep& training() { return *training_; }
  ModelStore& store() { return store_; }
  std::map<std::string, Numbers> gradients() {
    std::map<std::string, Numbers> all;
    for (const std::string& network : training_->model().groups())
      all[network] = training_->executor().read(training_->graph().gradient(network));
    return all;
  }
  /// Weights and running averages, and what Adam keeps.
  std::map<std::string, Numbers> learned() const {
    std::map<std::string, Numbers> all;
    for (const auto* entries : {&store_.layout().weights(), &store_.layout().optimiser()})
      for (const LayoutEntry& entry : *entries) all[entry.name] = store_.read(entry);
    return all;
  }

 private:
  Config config_;
  TrainingStage stage_;
  ModelStore store_;
  BatchPart part_;
  std::unique_ptr<TrainingStep> training_;
  std::unique_ptr<TripletSource> source_;
};

/// A step of 8 triplets in two portions, and each portion as a step of its own. In mixed precision both have
/// the same scale of the loss, so that gradients are compared as they lie.
void expect_means(Precision precision, double tolerance) {
  Config c = config();
  c.training.precision = precision;
  c.training.learning_rate = 1e-12;  // weights stay for the second portion
  c.training.accumulate = 2;
  Portioned both(c);
  const Losses losses = both.step();
  ASSERT_FALSE(both.training().skipped());
  c.training.accumulate = 1;
  c.training.batch = 4;
  Portioned one(c);
  std::map<std::string, Numbers> sums;
  Losses loss_sums;
  for (int portion = 0; portion < 2; ++portion) {
    const Triplets triplets = both.triplets(portion);
    for (const auto& [name, loss] : one.training().run(triplets, 1, 0)) loss_sums[name] += loss / 2;
    for (const auto& [network, gradient] : one.gradients()) {
      Numbers& sum = sums[network];
      sum.resize(gradient.size());
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += gradient[i] / 2;
    }
  }
  for (const auto& [name, loss] : loss_sums)
    EXPECT_NEAR(losses.at(name), loss, tolerance * std::fabs(loss)) << name;
  const auto gradients = both.gradients();
  ASSERT_EQ(gradients.size(), 3U);
  for (const auto& [network, sum] : sums)
    EXPECT_LT(relative_error(gradients.at(network), sum), tolerance) << network;
  const auto wanted = one.learned();
  for (const auto& [name, values] : both.learned()) {
    if (name.find("running_") == std::string::npos) continue;
    EXPECT_LT(relative_error(values, wanted.at(name)), tolerance) << name;
  }
}

TEST(Portions, GradientsAndLossesAreTheirMeansAndAveragesMoveWithEach) {
  expect_means(Precision::kFloat32, 1e-6);
}

/// A smaller share in the scaled loss rounds small gradients of activations elsewhere.
TEST(Portions, OfMixedPrecisionAreTheirMeansToo) { expect_means(Precision::kMixed, 1e-2); }

/// Batch norms of four portions and of two processes' two portions see the same triplets. Terms that join
/// scenes have those of a portion in all processes; here nothing is learned from them.
TEST(Portions, OfSeveralProcessesAreThoseOfOne) {
  Config c = config();
  c.training.accumulate = 4;
  Portioned alone(c);
  const Losses losses = alone.step();
  const auto gradients = alone.gradients();
  c.training.accumulate = 2;
  test::run_together(2, [&](Peers& peers) {
    const Device device({.selector = "", .on_message = fail_test});
    Portioned shared(c, &peers, device);
    for (const auto& [name, loss] : shared.step()) {
      if (name == "collapse") continue;
      EXPECT_NEAR(losses.at(name), loss, 1e-5 * std::fabs(loss)) << name;
    }
    for (const auto& [network, gradient] : shared.gradients())
      EXPECT_LT(relative_error(gradient, gradients.at(network)), 1e-5) << network;
  });
}

TEST(Portions, WhatIsNotFiniteInOneSkipsTheStepAndIsFound) {
  Config c = config();
  c.training.accumulate = 2;
  Portioned model(c);
  const auto before = model.learned();
  const auto with_infinity = [&](int portion) {
    Triplets triplets = model.triplets(portion);
    if (portion == 1) triplets.poses[5][0] = std::numeric_limits<double>::infinity();
    return triplets;
  };
  model.training().run(with_infinity, 1, 0);
  EXPECT_TRUE(model.training().skipped());
  EXPECT_TRUE(model.learned() == before);
  const std::string why = model.training().diagnosis(with_infinity, 1, 0);
  EXPECT_NE(why.find("not finite was "), std::string::npos) << why;
  EXPECT_NE(why.find(", portion 2 of 2"), std::string::npos) << why;
  EXPECT_TRUE(model.learned() == before);
  model.step();
  EXPECT_FALSE(model.training().skipped());
  EXPECT_FALSE(model.learned() == before);
}

TEST(Portions, MustBeEqual) {
  Config c = config();
  c.training.accumulate = 3;
  expect_error([&] { Portioned model(c); }, {"stage all", "8 triplets", "3 equal portions", "--accumulate"});
  c.training.batch = 6;
  test::run_together(4, [&](Peers& peers) {
    Config odd = c;
    odd.training.batch = 8;
    expect_error([&] { portion_batch(odd.stages().front(), &peers); }, {"2 triplets", "3 equal portions"});
  });
}

/// Trains up to `steps` of 4, as a process of its own would.
std::vector<std::byte> train(const std::filesystem::path& folder, const Config& config, uint64_t steps,
                             bool resume) {
  class Silent final : public TrainingListener {
    void show(const StepRecord&) override {}
    void say(std::string_view) override {}
  } silent;
  TrainerOptions options{
      .folder = RunFolder(folder), .data = "rooms:1", .steps = 4, .seed = 9, .eval_every = 0};
  Trainer trainer(test_device(), config, options, resume);
  trainer.run(silent, [&] { return trainer.position().step >= steps; });
  return read_file(RunFolder(folder).latest(), size_t{64} << 20);
}

TEST(Portions, AStoppedRunGoesOnToTheSameBytes) {
  const test::TempFolder folder;
  Config c = Config::parse(R"({
      "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
      "training": {"batch": 4, "stages": [
        {"name": "depth", "networks": ["depth"], "hypotheses": "background", "steps": 2, "accumulate": 2},
        {"name": "all", "accumulate": 4}]},
      "rooms": {"supersample": 1}})",
                           "test");
  const auto straight = train(folder / "straight", c, 4, false);
  train(folder / "stopped", c, 1, false);
  EXPECT_TRUE(train(folder / "stopped", c, 3, true) != straight);
  EXPECT_TRUE(train(folder / "stopped", c, 4, true) == straight);
  // Every portion counts as a call: two steps of two on one frame, two of four on three frames.
  EXPECT_EQ(SafetensorsFile(RunFolder(folder / "straight").latest())
                .read_ints("depth_model.depth_net.down1.conv.2.num_batches_tracked")
                .at(0),
            2 * 2 + 2 * 4 * 3);
  c.training.stages[1].accumulate = 2;
  expect_error([&] { train(folder / "stopped", c, 4, true); }, {"training.stages[1].accumulate", "4", "2"});
}

}  // namespace
}  // namespace vkopple
