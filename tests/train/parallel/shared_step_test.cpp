#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "runtime/device.h"
#include "runtime/error.h"
#include "tests/support/relative_error.h"
#include "tests/support/test_device.h"
#include "tests/support/threaded_peers.h"
#include "train/data/open_source.h"
#include "train/model_store.h"
#include "train/step_batch.h"
#include "train/training_step.h"

// A step of training in several processes against one with the whole batch. Sums are exact as in `verify`, so
// that no value is rounded over a kink.

namespace vkopple {
namespace {

using test::relative_error;

using Numbers = std::vector<float>;

constexpr uint64_t kSeed = 5;
constexpr int kBatch = 4;

/// Nothing is dropped: processes drop other values than one would.
Config config(bool sync) {
  return Config::parse(
      R"({"model": {"height": 32, "width": 32, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
                    "imagine_width": 1, "lstm": 8, "dropout": [0, 0, 0]},
          "training": {"batch": 4, "sync_batch_norm": )" +
          std::string(sync ? "true" : "false") + R"(}, "rooms": {"supersample": 1}})",
      "test");
}

std::unique_ptr<Device> exact_device_of_own() {
  return std::make_unique<Device>(DeviceOptions{.selector = "", .on_message = fail_test, .exact_sums = true});
}

struct Outcome {
  Losses losses;
  std::map<std::string, Numbers> gradients;  ///< as Adam takes them, by network
  std::map<std::string, Numbers> weights;    ///< after the last step
};

/// `steps` steps of a new model; `peers` may be null.
Outcome train(const Device& device, const Config& config, Peers* peers, int steps) {
  ModelStore store(device, config.model);
  store.initialise(kSeed);
  const TrainingStage stage = config.stages().front();
  TrainingStep training(device, config, stage, store.groups(), false, peers);
  const BatchPart part =
      peers == nullptr ? BatchPart{}
                       : BatchPart{static_cast<uint64_t>(peers->rank()), static_cast<uint64_t>(peers->count())};
  const auto source = open_triplets(device, "rooms:3", Lens(config.model), stage.rooms,
                                    static_cast<int>(training.batch()), {.seed = kSeed, .part = part});
  Outcome outcome;
  for (int step = 0; step < steps; ++step) {
    const auto n = static_cast<uint64_t>(step);
    outcome.losses = training.run(training_triplets(*source, kSeed, n, stage.batch, 0.5, 0, part), 1,
                                  static_cast<uint32_t>(step));
  }
  for (const std::string& network : training.model().groups())
    outcome.gradients[network] = training.executor().read(training.graph().gradient(network));
  for (const LayoutEntry& entry : store.layout().weights()) outcome.weights[entry.name] = store.read(entry);
  return outcome;
}

TEST(SharedStep, GradientsAreThoseOfOneProcess) {
  const auto one = exact_device_of_own();
  const Outcome whole = train(*one, config(true), nullptr, 1);
  test::run_together(2, [&](Peers& peers) {
    const auto device = exact_device_of_own();
    const Outcome shared = train(*device, config(true), &peers, 1);
    for (const auto& [name, loss] : whole.losses)
      EXPECT_NEAR(shared.losses.at(name), loss, 1e-5 * std::fabs(loss)) << name;
    ASSERT_EQ(shared.gradients.size(), 3U);
    for (const auto& [network, gradient] : whole.gradients)
      EXPECT_LT(relative_error(shared.gradients.at(network), gradient), 1e-4) << network;
  });
}

TEST(SharedStep, ProcessesKeepTheSameBits) {
  for (const bool sync : {true, false}) {
    std::vector<Outcome> outcomes(2);
    test::run_together(2, [&](Peers& peers) {
      const auto device = exact_device_of_own();
      outcomes[static_cast<size_t>(peers.rank())] = train(*device, config(sync), &peers, 2);
    });
    EXPECT_EQ(outcomes[0].losses, outcomes[1].losses);
    for (const auto& [name, values] : outcomes[0].weights)
      EXPECT_EQ(values, outcomes[1].weights.at(name)) << name;
    EXPECT_EQ(outcomes[0].gradients, outcomes[1].gradients);
  }
}

TEST(SharedStep, StatisticsOfAPartAreNotThoseOfTheWhole) {
  const auto one = exact_device_of_own();
  const Outcome whole = train(*one, config(false), nullptr, 1);
  test::run_together(2, [&](Peers& peers) {
    const auto device = exact_device_of_own();
    const Outcome shared = train(*device, config(false), &peers, 1);
    EXPECT_GT(relative_error(shared.gradients.at("object"), whole.gradients.at("object")), 1e-3);
  });
}

/// Exchanged while backward still runs. Nothing joins the parts here: statistics are their own, the collapse
/// term is 0.
TEST(SharedStep, GradientsAreTheMeansOfThoseOfTheParts) {
  Config c = config(false);
  c.model.reg = 0;
  std::vector<Outcome> shared(2);
  test::run_together(2, [&](Peers& peers) {
    const auto device = exact_device_of_own();
    shared[static_cast<size_t>(peers.rank())] = train(*device, c, &peers, 1);
  });
  c.training.batch = kBatch / 2;
  const auto device = exact_device_of_own();
  std::map<std::string, Numbers> sums;
  for (uint64_t rank = 0; rank < 2; ++rank) {
    ModelStore store(*device, c.model);
    store.initialise(kSeed);
    const TrainingStage stage = c.stages().front();
    TrainingStep training(*device, c, stage, store.groups());
    const BatchPart part{rank, 2};
    const auto source = open_triplets(*device, "rooms:3", Lens(c.model), stage.rooms, kBatch / 2,
                                      {.seed = kSeed, .part = part});
    Triplets triplets = training_triplets(*source, kSeed, 0, kBatch, 0.5, 0, part);
    triplets.permutation = {0, 1};
    training.run(triplets, 1, 0);
    for (const std::string& network : training.model().groups()) {
      const Numbers own = training.executor().read(training.graph().gradient(network));
      Numbers& sum = sums[network];
      sum.resize(own.size());
      for (size_t i = 0; i < own.size(); ++i) sum[i] += own[i];
    }
  }
  for (auto& [network, sum] : sums) {
    for (float& v : sum) v /= 2;
    for (const Outcome& outcome : shared)
      EXPECT_LT(relative_error(outcome.gradients.at(network), sum), 1e-6) << network;
  }
}

TEST(SharedStep, ABatchMustHaveEqualParts) {
  test::run_together(3, [](Peers& peers) {
    const Config c = config(false);
    ModelStore store(test_device(), c.model);
    try {
      const TrainingStep training(test_device(), c, c.stages().front(), store.groups(), false, &peers);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("a batch of 4 has no 3 equal parts"), std::string::npos)
          << error.what();
    }
  });
}

}  // namespace
}  // namespace vkopple
