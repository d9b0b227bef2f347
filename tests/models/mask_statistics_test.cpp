#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/opple.h"
#include "runtime/error.h"
#include "tests/support/fed_model.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"

namespace vkopple {
namespace {

constexpr int64_t kBatch = 3;

ModelConfig model_with(MaskStatistics statistics) {
  ModelConfig config = test::tiny_config().model;
  config.mask_statistics = statistics;
  config.slot_counters = config.slots - 1;  // codes that differ from slot to slot alone
  config.dropout = {0, 0, 0};
  return config;
}

/// The same image, with some texture, in all places of a batch and in all frames.
Triplets one_image(const ModelConfig& config) {
  Triplets t;
  for (int64_t i = 0; i < 3 * kBatch; ++i) {
    for (int64_t j = 0; j < int64_t{3} * config.height * config.width; ++j)
      t.images.push_back(static_cast<float>(j * j % 29) / 29);
    t.poses.push_back({0, 0, 0.7, 0, 0, 0});
  }
  t.permutation = {1, 2, 0};
  return t;
}

/// How far the mask logits of the first two slots are apart in a training step, at most.
double apart(MaskStatistics statistics) {
  const ModelConfig config = model_with(statistics);
  Graph graph;
  const Opple model(graph, config, {.batch = kBatch, .training = true, .keep_stages = true});
  Executor executor(test_device(), graph, {.loss = model.loss(), .trained = model.groups()});
  test::feed_drawn(executor, model, one_image(config));
  executor.forward();
  const auto logits = executor.read(Value(graph, graph.kept().at("out/o2.mask_logits")));
  const size_t slot = static_cast<size_t>(kBatch * config.height * config.width);
  double most = 0;
  for (size_t i = 0; i < slot; ++i)
    most =
        std::max(most, std::abs(static_cast<double>(logits.at(i)) - static_cast<double>(logits.at(slot + i))));
  return most;
}

// What all images of a slot have in common is the statistics' mean and gone after the first batch norm.
TEST(MaskStatistics, ApartWhatTellsSlotsAloneDoesNotReachMasks) {
  EXPECT_LT(apart(MaskStatistics::kApart), 1e-3);
}

TEST(MaskStatistics, TogetherItDoes) { EXPECT_GT(apart(MaskStatistics::kTogether), 0.1); }

TEST(MaskStatistics, TogetherNeedsRoomForAllSlots) {
  Graph graph;
  try {
    const Opple model(graph, model_with(MaskStatistics::kTogether),
                      {.batch = kBatch, .training = true, .max_tensor_bytes = 1});
    FAIL() << "was built";
  } catch (const Error& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "this device can't bind the masks of 2 slots of 3 images at once, as mask_statistics \"together\" "
        "needs; give a smaller --batch");
  }
}

}  // namespace
}  // namespace vkopple
