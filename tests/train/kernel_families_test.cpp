#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <memory>

#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"
#include "train/random.h"
#include "train/training_step.h"

namespace vkopple {
namespace {

/// Losses of one step, and every network's gradient after it.
struct Outcome {
  std::map<std::string, double> losses;
  std::map<std::string, std::vector<float>> gradients;
};

Triplets made_up(const ModelConfig& model, int64_t batch) {
  Triplets t;
  Random random(5, 0);
  t.images.resize(static_cast<size_t>(3 * batch * 3 * model.height * model.width));
  for (float& v : t.images) v = static_cast<float>(random.uniform());
  for (int frame = 0; frame < 3; ++frame)
    for (int64_t b = 0; b < batch; ++b)
      t.poses.push_back({0.05 * frame, 0.02 * frame, 0.7, 0.03 * frame, 0, 0});
  for (int64_t b = 0; b < batch; ++b) t.permutation.push_back(static_cast<uint32_t>((b + 1) % batch));
  return t;
}

Outcome step(const Device& device) {
  const Config config = Config::load("tiny");
  TrainingStage stage = config.stages().back();
  stage.batch = 2;
  TrainingStep training(device, config, stage, nullptr);
  Executor& executor = training.executor();
  for (const InitialTensor& t : training.model().tensors())
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 1, t.name));
  Outcome outcome{.losses = training.run(made_up(config.model, stage.batch), 1, 0), .gradients = {}};
  for (const auto& [group, members] : training.graph().parameters())
    for (const GroupMember& member : members) {
      const auto gradient = executor.read_gradient(Value(training.graph(), member.value));
      auto& all = outcome.gradients[group];
      all.insert(all.end(), gradient.begin(), gradient.end());
    }
  return outcome;
}

/// |a − b| / |b|, root mean squares.
double difference(const std::vector<float>& a, const std::vector<float>& b) {
  double error = 0;
  double scale = 0;
  for (size_t i = 0; i < b.size(); ++i) {
    error += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
    scale += std::pow(static_cast<double>(b[i]), 2);
  }
  return std::sqrt(error / scale);
}

// Nothing that rounding moves over a kink may come between two families: the shared one adds in the plain one's
// order (as does the cooperative one, which leaves float32 to it), and registers, whose kernels have orders of
// their own, keep what their sums round off. The reductions of the weight gradients differ.
TEST(KernelFamilies, OneTrainingStepIsTheSameButForRounding) {
  const bool cpu = test_device().caps().cpu();
  const Outcome plain = step(*family_device(KernelFamily::kPlain));
  const Outcome plain_exact = cpu ? step(*family_device(KernelFamily::kPlain, true)) : plain;
  for (const KernelFamily family :
       {KernelFamily::kAuto, KernelFamily::kRegisters, KernelFamily::kShared, KernelFamily::kCooperative}) {
    const bool exact = cpu && (family == KernelFamily::kAuto || family == KernelFamily::kRegisters);
    const Device* device = family_device(family, exact);
    if (device == nullptr) {
      std::cout << "left out: " << missing_for(family, test_device().caps()) << "\n";
      continue;
    }
    SCOPED_TRACE(static_cast<int>(family));
    const Outcome& want = exact ? plain_exact : plain;
    const Outcome got = step(*device);
    ASSERT_FALSE(want.losses.empty());
    for (const auto& [name, loss] : want.losses)
      EXPECT_NEAR(got.losses.at(name), loss, 1e-5 * (1 + std::abs(loss))) << name;
    ASSERT_EQ(got.gradients.size(), want.gradients.size());
    for (const auto& [group, gradient] : want.gradients) {
      ASSERT_EQ(got.gradients.at(group).size(), gradient.size()) << group;
      EXPECT_LE(difference(got.gradients.at(group), gradient), 1e-5) << group;
    }
  }
}

}  // namespace
}  // namespace vkopple
