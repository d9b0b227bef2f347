#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <vector>

#include "graph/ops/back_project.h"
#include "models/opple.h"
#include "models/perception_graph.h"
#include "tests/support/fed_model.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"

namespace vkopple {
namespace {

using testing::FloatNear;
using testing::Not;
using testing::Pointwise;

constexpr float kTolerance = 1e-4F;
constexpr int64_t kBatch = 2;

/// One slot, whose match is certain, within a window, so that masks and with them centroids differ.
ModelConfig one_slot(bool mask_location) {
  ModelConfig config = test::tiny_config().model;
  config.slots = 1;
  config.mask_window = 1;
  config.mask_location = mask_location;
  config.statistics_frames = StatisticsFrames::kSecond;
  return config;
}

std::vector<float> random_images(const ModelConfig& config, int64_t count) {
  std::mt19937 random(7);
  std::vector<float> images(static_cast<size_t>(count * 3 * config.height * config.width));
  for (float& value : images) value = static_cast<float>(random() % 1000) / 1000;
  return images;
}

/// What a pass keeps of three frames that a camera which stands still saw.
std::map<std::string, std::vector<float>> seen_by_a_still_camera(const ModelConfig& config) {
  Graph graph;
  const Opple model(graph, config, {.batch = kBatch, .keep_stages = true});
  Executor executor(test_device(), graph, {});
  Triplets t;
  t.images = random_images(config, 3 * kBatch);
  t.poses.resize(3 * kBatch);
  t.permutation = {1, 0};
  test::feed_drawn(executor, model, t);
  executor.forward();
  std::map<std::string, std::vector<float>> kept;
  for (const auto& [name, id] : graph.kept()) kept[name] = executor.read(Value(graph, id));
  return kept;
}

/// Where q (after - before) leads from `after` in one more step.
std::vector<float> one_step_on(const std::vector<float>& before, const std::vector<float>& after,
                               const std::vector<float>& q) {
  std::vector<float> next;
  for (size_t i = 0; i < after.size(); ++i) next.push_back(after[i] + q[i / 3] * (after[i] - before[i]));
  return next;
}

TEST(MaskLocation, MotionIsThatOfCentroids) {
  auto kept = seen_by_a_still_camera(one_slot(true));
  const auto expected = one_step_on(kept["out/o1.centroid"], kept["out/o2.centroid"], kept["out/q12"]);
  EXPECT_THAT(kept["out/location3"], Pointwise(FloatNear(kTolerance), expected));
  EXPECT_THAT(kept["out/o1.centroid"], Not(Pointwise(FloatNear(0.01F), kept["out/o2.centroid"])));
  EXPECT_THAT(kept["out/o2.centroid"], Not(Pointwise(FloatNear(0.01F), kept["out/o2.location"])));
}

TEST(MaskLocation, WithoutItMotionIsWhatSlotsSay) {
  auto kept = seen_by_a_still_camera(one_slot(false));
  EXPECT_FALSE(kept.contains("out/o2.centroid"));
  const auto expected = one_step_on(kept["out/o1.location"], kept["out/o2.location"], kept["out/q12"]);
  EXPECT_THAT(kept["out/location3"], Pointwise(FloatNear(kTolerance), expected));
}

// At X = Σ π P / Σ π, P being what the depth that was seen makes of pixels.
TEST(MaskLocation, PerceptionGivesCentroids) {
  const ModelConfig config = one_slot(true);
  Graph graph;
  const PerceptionGraph perception = perception_graph(graph, config, 1, true, ~uint64_t{0});
  const Value points = back_project(perception.depth, static_cast<float>(config.fov));
  graph.keep("points", points);
  Executor executor(test_device(), graph, {});
  for (const InitialTensor& t : perception.tensors)
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 3, t.name));
  executor.write(perception.images, random_images(config, 1));
  executor.forward();
  const auto masks = executor.read(perception.objects.masks);
  const auto where = executor.read(points);
  const size_t pixels = where.size() / 3;
  std::vector<float> expected;
  for (size_t axis = 0; axis < 3; ++axis) {
    double weight = 0, sum = 0;
    for (size_t i = 0; i < pixels; ++i) {
      weight += double{masks[i]};
      sum += double{masks[i]} * double{where[axis * pixels + i]};
    }
    expected.push_back(static_cast<float>(sum / weight));
  }
  EXPECT_THAT(executor.read(Value(graph, graph.kept().at("location"))),
              Pointwise(FloatNear(kTolerance), expected));
}

}  // namespace
}  // namespace vkopple
