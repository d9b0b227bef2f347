#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "graph/executor.h"
#include "graph/ops/adam.h"
#include "graph/ops/linear.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

/// With a loss w · x the gradient of w is x at every step; then Adam moves w by learning_rate · g / (|g| +
/// epsilon) exactly, however many steps came before.
TEST(AdamTest, AConstantGradientMovesParametersAtAConstantRate) {
  constexpr int kSteps = 300;
  constexpr double kRate = 0.01;
  constexpr double kEpsilon = 0.1;
  const std::vector<float> gradient{0.5F, -0.25F, 3.0F, 0.0F, -7.0F};
  Graph graph;
  const Value x = graph.input("x", row_major({1, 5}));
  const Value w = graph.parameter("net", "w", {1, 5});
  const Value other = graph.parameter("net", "unused", {3});
  const Value loss = graph.reshape(linear(x, w, {}), row_major({1}));
  const Value rate = learning_rate(graph);
  adam(graph, "net", {.epsilon = kEpsilon, .clip = 2}, rate);
  Executor executor(test_device(), graph, {.groups = {}, .loss = loss, .trained = {"net"}});
  executor.write(x, gradient);
  executor.write(rate, std::vector<float>{static_cast<float>(kRate)});
  executor.write(w, std::vector<float>(5, 1.0F));
  executor.write(other, std::vector<float>{1, 2, 3});
  for (int step = 0; step < kSteps; ++step) {
    executor.forward();
    executor.backward();
    executor.update();
  }
  const auto moved = executor.read(w);
  for (size_t i = 0; i < gradient.size(); ++i) {
    const double g = std::min(std::max(static_cast<double>(gradient[i]), -2.0), 2.0);
    EXPECT_NEAR(moved[i], 1 - kSteps * kRate * g / (std::abs(g) + kEpsilon), 2e-5) << i;
  }
  EXPECT_EQ(executor.read(other), (std::vector<float>{1, 2, 3}));
  const auto correction = executor.read(graph.find("adam/net/correction"));
  EXPECT_NEAR(correction[1], 1 - std::pow(0.999, kSteps), 1e-6);
}

TEST(AdamTest, TheRateIsThatOfTheStep) {
  Graph graph;
  const Value x = graph.input("x", row_major({1, 4}));
  const Value w = graph.parameter("net", "w", {1, 4});
  const Value loss = graph.reshape(linear(x, w, {}), row_major({1}));
  const Value rate = learning_rate(graph);
  adam(graph, "net", {.epsilon = 1}, rate);
  Executor executor(test_device(), graph, {.groups = {}, .loss = loss, .trained = {"net"}});
  executor.write(x, std::vector<float>(4, 1));
  executor.write(w, std::vector<float>(4, 0));
  for (const float r : {0.5F, 0.0F, 0.25F}) {
    executor.write(rate, std::vector<float>{r});
    executor.forward();
    executor.backward();
    executor.update();
  }
  for (const float moved : executor.read(w)) EXPECT_NEAR(moved, -0.75 / 2, 1e-6);
}

/// More parameters than a workgroup takes, so that rows are stored where the device does that, and a last row
/// that is not whole; each element as in the test above.
TEST(AdamTest, ManyParametersAreMovedAlike) {
  constexpr int64_t kCount = 1036;
  Graph graph;
  const Value x = graph.input("x", row_major({1, kCount}));
  const Value w = graph.parameter("net", "w", {1, kCount});
  const Value loss = graph.reshape(linear(x, w, {}), row_major({1}));
  const Value rate = learning_rate(graph);
  adam(graph, "net", {.epsilon = 0.1, .clip = 2}, rate);
  Executor executor(test_device(), graph, {.groups = {}, .loss = loss, .trained = {"net"}});
  std::vector<float> gradient(kCount);
  for (size_t i = 0; i < gradient.size(); ++i) gradient[i] = 0.003F * static_cast<float>(i) - 1.5F;
  executor.write(x, gradient);
  executor.write(rate, std::vector<float>{0.01F});
  executor.write(w, std::vector<float>(kCount, 1.0F));
  for (int step = 0; step < 3; ++step) {
    executor.forward();
    executor.backward();
    executor.update();
  }
  const auto moved = executor.read(w);
  for (size_t i = 0; i < gradient.size(); ++i) {
    const double g = static_cast<double>(gradient[i]);
    EXPECT_NEAR(moved[i], 1 - 3 * 0.01 * g / (std::abs(g) + 0.1), 1e-6) << i;
  }
}

}  // namespace
}  // namespace vkopple
