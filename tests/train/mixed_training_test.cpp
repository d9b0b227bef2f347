#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <vector>

#include "graph/ops/loss_scale.h"
#include "models/perception.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/data/open_source.h"
#include "train/progress.h"
#include "train/safetensors.h"
#include "train/step_batch.h"
#include "train/trainer.h"
#include "train/training_step.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;
using test::tiny_config;

constexpr uint64_t kSeed = 3;

Config config_in(Precision precision) {
  Config config = tiny_config();
  config.training.precision = precision;
  for (TrainingStage& stage : config.training.stages) stage.batch = 4;
  return config;
}

// The yardstick of both comparisons is float32 with every weight moved by 2^-11 of itself, up or down: a
// rounding of float16's size in each layer. Mixed precision rounds a layer's activations some three times, and
// their gradients as often, each by a root mean square of 2^-11 / sqrt(3) at most: together 1.4 times the
// yardstick. Limits are twice that for gradients at one point, and rounded up to twice the yardstick for means
// over many steps.
constexpr double kGradientLimit = 2.8;
// Kernels of cooperative matrices also round weights, by 1 / sqrt(3) of the yardstick.
constexpr double kCooperativeGradientLimit = 3.0;
constexpr double kCurveLimit = 2;

/// Moves every value by 2^-11 of itself, up or down.
std::vector<float> moved(std::vector<float> values) {
  uint32_t random = 1;
  for (float& v : values) v *= 1 + ((random = random * 1664525 + 1013904223) >> 31 == 0 ? 1.0F : -1.0F) / 2048;
  return values;
}

/// The last stage of the tiny model on rooms, in one precision.
class Training {
 public:
  explicit Training(Precision precision) : Training(config_in(precision), 1) {}
  explicit Training(Config config, size_t stage)
      : config_(std::move(config)),
        stage_(config_.stages().at(stage)),
        store_(test_device(), config_.model, config_.training.precision),
        source_(open_triplets(test_device(), "rooms:5", Lens(config_.model), stage_.rooms, stage_.batch,
                              {.seed = kSeed})),
        training_(test_device(), config_, stage_, store_.groups()) {
    store_.initialise(kSeed);
  }

  std::map<std::string, double> step() {
    const auto triplets =
        training_triplets(*source_, kSeed, next_, stage_.batch, config_.training.reverse_probability,
                          training_.model().first_frame());
    return training_.run(triplets, kSeed, next_++);
  }
  void move_weights() {
    for (const LayoutEntry& entry : store_.layout().weights()) store_.write(entry, moved(store_.read(entry)));
  }
  std::vector<float> scale() { return training_.executor().read(training_.graph().find(kLossScaleState)); }
  void set_scale(const std::vector<float>& state) {
    training_.executor().write(training_.graph().find(kLossScaleState), state);
  }
  ModelStore& store() { return store_; }
  TrainingStep& training() { return training_; }

  std::vector<std::vector<float>> averages() const { return weights(true); }

  /// Weights and the state of Adam.
  std::vector<std::vector<float>> learned() const {
    std::vector<std::vector<float>> all = weights(false);
    for (const LayoutEntry& entry : store_.layout().optimiser())
      if (entry.name != kLossScaleState) all.push_back(store_.read(entry));
    return all;
  }

 private:
  /// Those that are running averages, or those that are not.
  std::vector<std::vector<float>> weights(bool running) const {
    std::vector<std::vector<float>> all;
    for (const LayoutEntry& entry : store_.layout().weights())
      if ((entry.name.find("running_") != std::string::npos) == running) all.push_back(store_.read(entry));
    return all;
  }

  Config config_;
  TrainingStage stage_;
  ModelStore store_;
  std::unique_ptr<TripletSource> source_;
  TrainingStep training_;
  uint32_t next_ = 0;
};

// A smooth picture: a model that sees it and does not normalise by its batch has a loss that can be
// differentiated. (In training the gradient is rougher: moving every weight by 2^-11 of itself changes it by as
// much as its size, in float32.)
Triplets smooth_triplets(const ModelConfig& model, int64_t batch) {
  Triplets t;
  for (int frame = 0; frame < 3; ++frame)
    for (int64_t b = 0; b < batch; ++b) {
      for (int c = 0; c < 3; ++c)
        for (int y = 0; y < model.height; ++y)
          for (int x = 0; x < model.width; ++x)
            t.images.push_back(
                static_cast<float>(0.5 + 0.25 * std::sin(0.3 * x + 0.15 * frame + static_cast<double>(b)) +
                                   0.2 * std::cos(0.4 * y + 0.7 * c)));
      t.poses.push_back({0.03 * frame, 0.05 * frame, 0.7, 0.02 * frame, 0, 0});
    }
  for (int64_t b = 0; b < batch; ++b) t.permutation.push_back(static_cast<uint32_t>((b + 1) % batch));
  return t;
}

/// The loss and every network's gradient at the start.
std::map<std::string, std::vector<double>> gradients(Precision precision, float scale, bool move = false,
                                                     const Device& device = test_device()) {
  constexpr int64_t kBatch = 3;
  Config config = tiny_config();
  config.model.height = config.model.width = 32;
  Graph graph;
  const Opple model(graph, config.model, {.batch = kBatch, .training = false, .precision = precision});
  const Value seed = graph.input("scale", row_major({1}));
  Executor executor(device, graph,
                    {.groups = {}, .loss = model.loss(), .trained = model.groups(), .loss_scale = seed});
  for (const InitialTensor& t : model.tensors()) {
    const auto values = initial_values(t.initial, t.value.shape().elements(), kSeed, t.name);
    executor.write(t.value, move ? moved(values) : values);
  }
  executor.write(seed, std::vector<float>{scale});
  model.feed_constants(executor);
  model.feed_random(executor, 0, 0);
  model.feed(executor, smooth_triplets(config.model, kBatch));
  executor.forward();
  executor.backward();
  std::map<std::string, std::vector<double>> all;
  all["loss"] = {static_cast<double>(executor.read(model.loss())[0])};
  for (const auto& [group, members] : graph.parameters())
    for (const GroupMember& member : members)
      for (const float g : executor.read_gradient(Value(graph, member.value)))
        all[group].push_back(static_cast<double>(g) / static_cast<double>(scale));
  return all;
}

double relative_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference2 = 0;
  double size2 = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference2 += (a[i] - b[i]) * (a[i] - b[i]);
    size2 += a[i] * a[i];
  }
  return std::sqrt(difference2 / size2);
}

using Gradients = std::map<std::string, std::vector<double>>;

void expect_near(const Gradients& mixed, const Gradients& single, const Gradients& yardstick, double times) {
  for (const auto& [what, values] : single) {
    const double limit = times * relative_difference(values, yardstick.at(what));
    EXPECT_LE(relative_difference(values, mixed.at(what)), limit) << what;
    EXPECT_GT(relative_difference(values, mixed.at(what)), 0) << what;
    EXPECT_LT(limit, 0.5) << what << ": nothing would be compared";
    std::cout << what << ": " << relative_difference(values, mixed.at(what)) << ", limit " << limit << "\n";
  }
}

TEST(MixedTraining, GradientsAreThoseOfFloat32) {
  const auto single = gradients(Precision::kFloat32, 1);
  // A power of two changes nothing in float32.
  EXPECT_EQ(gradients(Precision::kFloat32, 256), single);
  const auto mixed = gradients(Precision::kMixed, 256);
  const auto yardstick = gradients(Precision::kFloat32, 1, true);
  expect_near(mixed, single, yardstick, kGradientLimit);
  const Device* cooperative = family_device(KernelFamily::kCooperative);
  if (cooperative == nullptr) {
    std::cout << missing_for(KernelFamily::kCooperative, test_device().caps()) << "\n";
    return;
  }
  const auto matrices = gradients(Precision::kMixed, 256, false, *cooperative);
  EXPECT_NE(matrices, mixed);
  expect_near(matrices, single, yardstick, kCooperativeGradientLimit);
}

TEST(MixedTraining, FollowsTheLossOfFloat32) {
  for (const size_t stage : {0U, 1U}) {
    Training single(config_in(Precision::kFloat32), stage);
    Training mixed(config_in(Precision::kMixed), stage);
    Training yardstick(config_in(Precision::kFloat32), stage);
    yardstick.move_weights();
    double sum = 0;
    double mixed_away = 0;
    double yardstick_away = 0;
    for (int step = 0; step < 40; ++step) {
      const double loss = single.step().at("image");
      sum += loss;
      mixed_away += std::abs(mixed.step().at("image") - loss);
      yardstick_away += std::abs(yardstick.step().at("image") - loss);
    }
    EXPECT_LE(mixed_away, kCurveLimit * yardstick_away) << "stage " << stage;
    EXPECT_GT(mixed_away, 0) << "stage " << stage;
    std::cout << "stage " << stage << ": " << mixed_away / sum << ", yardstick " << yardstick_away / sum
              << "\n";
    EXPECT_LE(mixed.scale()[LossScale::kSkipped], 6);
  }
}

TEST(MixedTraining, TakesLessMemory) {
  Training single(Precision::kFloat32);
  Training mixed(Precision::kMixed);
  EXPECT_LT(mixed.training().executor().shared_bytes(), single.training().executor().shared_bytes() * 3 / 4);
}

TEST(MixedTraining, AnOverflowChangesNothingButTheScale) {
  Training mixed(Precision::kMixed);
  mixed.step();
  // A power of two that takes gradients beyond float16, and then back.
  const float huge = std::ldexp(1.0F, 60);
  mixed.set_scale({huge, 7, 2, 0.5F});
  const auto before = mixed.learned();
  mixed.step();
  EXPECT_EQ(mixed.scale(), (std::vector<float>{huge / 2, 0, 3, 0}));
  EXPECT_EQ(mixed.learned(), before);
  mixed.set_scale({1, 0, 3, 0});
  mixed.step();
  EXPECT_EQ(mixed.scale(), (std::vector<float>{1, 1, 3, 1}));
  EXPECT_NE(mixed.learned(), before);
}

TEST(MixedTraining, WhatIsNeverFiniteIsSkipped) {
  Training mixed(Precision::kMixed);
  // A scale that is no number makes no gradient finite, and is halved to the smallest.
  mixed.set_scale({std::numeric_limits<float>::quiet_NaN(), 0, 4, 0});
  const auto before = mixed.learned();
  const auto averages = mixed.averages();
  mixed.step();
  EXPECT_TRUE(mixed.training().skipped());
  EXPECT_EQ(mixed.learned(), before);
  EXPECT_EQ(mixed.averages(), averages);
  // The scale is 1 now, and finite gradients are not skipped.
  mixed.step();
  EXPECT_FALSE(mixed.training().skipped());
  EXPECT_NE(mixed.learned(), before);
  EXPECT_NE(mixed.averages(), averages);
}

TEST(MixedTraining, AnOverflowOfTheScaleIsNotCounted) {
  Training mixed(Precision::kMixed);
  mixed.set_scale({std::ldexp(1.0F, 60), 7, 2, 0.5F});
  mixed.step();
  EXPECT_FALSE(mixed.training().skipped());
}

TEST(MixedTraining, SeesWhatFloat32Sees) {
  const Config config = tiny_config();
  ModelStore store(test_device(), config.model);
  store.initialise(kSeed);
  std::vector<float> image(static_cast<size_t>(3 * config.model.height * config.model.width));
  for (size_t i = 0; i < image.size(); ++i) image[i] = static_cast<float>((i * 7919) % 256) / 255;
  Percepts seen[2];
  for (const Precision precision : {Precision::kFloat32, Precision::kMixed}) {
    Perception perception(test_device(), config.model, store.groups(), {.batch = 1, .precision = precision});
    seen[static_cast<size_t>(precision)] = perception.see(image);
  }
  // Depth is a sigmoid of a logit that some 25 stores lead to: off by at most 25 · 2^-11 of its size, which is
  // below 1 in a network that has not learned; a sigmoid is nowhere steeper than 1/4.
  const double depth_limit = config.model.max_depth / 4 * 25 / 2048;
  for (size_t i = 0; i < seen[0].depth.size(); ++i)
    ASSERT_NEAR(seen[1].depth[i], seen[0].depth[i], depth_limit);
  for (size_t i = 0; i < seen[0].masks.size(); ++i) ASSERT_NEAR(seen[1].masks[i], seen[0].masks[i], 0.02);
  EXPECT_NE(seen[0].depth, seen[1].depth);
}

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

bool train(const std::filesystem::path& folder, uint64_t steps, bool resume, Precision precision) {
  const std::unique_ptr<std::FILE, Close> sink(std::tmpfile());
  Progress progress(sink.get(), false, 4);
  Config config = config_in(precision);
  config.training.stages.erase(config.training.stages.begin());
  TrainerOptions options{.folder = RunFolder(folder), .data = "rooms:1", .steps = 4, .seed = 9};
  options.eval_every = 0;
  Trainer trainer(test_device(), config, options, resume);
  return trainer.run(progress, [&] { return trainer.position().step >= steps; });
}

TEST(MixedTraining, StoppedAndResumedItWritesTheSameBytes) {
  const TempFolder folder;
  EXPECT_TRUE(train(folder / "straight", 4, false, Precision::kMixed));
  EXPECT_FALSE(train(folder / "stopped", 2, false, Precision::kMixed));
  EXPECT_TRUE(train(folder / "stopped", 4, true, Precision::kMixed));
  const RunFolder straight(folder / "straight");
  constexpr size_t kLargestFile = size_t{64} << 20;
  EXPECT_EQ(read_file(straight.latest(), kLargestFile),
            read_file(RunFolder(folder / "stopped").latest(), kLargestFile));
  const SafetensorsFile file(straight.latest());
  EXPECT_EQ(file.read_floats(kLossScaleState), (std::vector<float>{256, 4, 0, 1.0F / 256}));
  EXPECT_EQ(read_checkpoint_header(straight.latest()).config.training.precision, Precision::kMixed);
  EXPECT_EQ(load_model(test_device(), straight.latest()).position.step, 4U);
  expect_error([&] { train(folder / "straight", 4, true, Precision::kFloat32); },
               {"training.precision", "mixed"});
}

}  // namespace
}  // namespace vkopple
