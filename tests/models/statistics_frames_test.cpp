#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "models/opple.h"
#include "tests/support/fed_model.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"

namespace vkopple {
namespace {

constexpr int64_t kBatch = 3;

Triplets random_triplets(const ModelConfig& config) {
  std::mt19937 random(7);
  Triplets t;
  for (int64_t i = 0; i < 3 * kBatch * 3 * config.height * config.width; ++i)
    t.images.push_back(static_cast<float>(random() % 1000) / 1000);
  for (int frame = 0; frame < 3; ++frame)
    for (int64_t b = 0; b < kBatch; ++b)
      t.poses.push_back({0.05 * frame, 0.02 * frame, 0.7, 0.03 * frame * static_cast<double>(b), 0, 0});
  t.permutation = {1, 2, 0};
  return t;
}

using Tensors = std::map<std::string, std::vector<float>>;

/// Everything that comes out of one forward and backward pass, by name.
struct Pass {
  Tensors kept;  ///< stages and losses
  Tensors gradients;
  Tensors averages;
};

Pass run(StatisticsFrames frames, bool training, uint64_t max_tensor_bytes) {
  ModelConfig config = test::tiny_config().model;
  config.statistics_frames = frames;
  config.dropout = {0, 0, 0};  // what is dropped depends on how the frames are called
  Graph graph;
  const Opple model(
      graph, config,
      {.batch = kBatch, .training = training, .keep_stages = true, .max_tensor_bytes = max_tensor_bytes});
  Executor executor(test_device(), graph, {.loss = model.loss(), .trained = model.groups()});
  test::feed_drawn(executor, model, random_triplets(config));
  executor.forward();
  executor.backward();
  Pass pass;
  for (const auto& [name, id] : graph.kept()) pass.kept[name] = executor.read(Value(graph, id));
  for (const InitialTensor& t : model.tensors()) {
    if (t.name.find(".running_") == t.name.npos)
      pass.gradients[t.name] = executor.read_gradient(t.value);
    else
      pass.averages[t.name] = executor.read(t.value);
  }
  return pass;
}

bool of_frames_1_and_3(const std::string& name) {
  return name.find("o1.mask") != name.npos || name.find("o3.mask") != name.npos;
}

/// The depth network's and the mask decoder's.
bool sees_the_second_frame_alone(const std::string& average) {
  return average.starts_with("depth_model.") || average.find("_att.") != average.npos;
}

class StatisticsFramesTest : public testing::TestWithParam<std::tuple<bool, uint64_t>> {
 protected:
  Pass run(StatisticsFrames frames) const {
    return vkopple::run(frames, std::get<0>(GetParam()), std::get<1>(GetParam()));
  }
};

// Frames have statistics of their own, so a frame that no loss reads changes nothing but running averages.
TEST_P(StatisticsFramesTest, LossesAndGradientsAreThoseOfAllFrames) {
  const Pass all = run(StatisticsFrames::kAll);
  Pass second = run(StatisticsFrames::kSecond);
  EXPECT_GT(all.gradients.size(), 100U);
  EXPECT_EQ(all.gradients, second.gradients);
  size_t left_out = 0;
  for (const auto& [name, values] : all.kept) {
    if (of_frames_1_and_3(name)) {
      ++left_out;
      EXPECT_FALSE(second.kept.contains(name)) << name;
    } else {
      EXPECT_EQ(values, second.kept[name]) << name;
    }
  }
  EXPECT_EQ(left_out, 4U);
  EXPECT_GT(std::abs(all.kept.at("loss/total").at(0)), 0.0F);
}

TEST_P(StatisticsFramesTest, RunningAveragesSeeTheFramesTheyAreTold) {
  const Pass all = run(StatisticsFrames::kAll);
  Pass second = run(StatisticsFrames::kSecond);
  const bool training = std::get<0>(GetParam());
  for (const auto& [name, values] : all.averages) {
    const bool differ = training && sees_the_second_frame_alone(name);
    EXPECT_EQ(values != second.averages[name], differ) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(TrainingAndSize, StatisticsFramesTest,
                         testing::Combine(testing::Bool(),
                                          // The second: frames and slots one by one.
                                          testing::Values(~uint64_t{0},
                                                          uint64_t{int64_t{16} * 16 * 16 * kBatch})));

}  // namespace
}  // namespace vkopple
