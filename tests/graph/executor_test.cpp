#include "graph/executor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "graph/ops/batch_norm.h"
#include "graph/ops/binary.h"
#include "graph/ops/concat.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/image_loss.h"
#include "graph/ops/leaky_relu.h"
#include "graph/ops/relayout.h"
#include "graph/ops/slice.h"
#include "runtime/error.h"
#include "runtime/transfer.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

TEST(ExecutorTest, GradientsOfViewsAddUp) {
  // Two aligned views of one parameter, each used twice: d/dw of the sum of four uses.
  Graph graph;
  const Value w = graph.parameter("p", "w", {2, 64});
  std::vector<Value> uses;
  for (const int64_t row : {0, 1, 0}) uses.push_back(leaky_relu(graph.slice_outer(w, row, 1), 0.5F));
  Value loss = slice(graph.reshape(concat(uses, 0), row_major({192})), 0, 0, 1);
  graph.keep("loss", loss);
  Executor executor(test_device(), graph, {.loss = loss, .trained = {"p"}});
  std::vector<float> values(128, -2.0F);
  values[64] = 3.0F;
  executor.write(w, values);
  executor.forward();
  executor.backward();
  EXPECT_EQ(executor.read(loss)[0], -1.0F);
  std::vector<float> expected(128, 0.0F);
  expected[0] = 0.5F;  // of the three uses only the first row's first number reaches the loss
  EXPECT_EQ(executor.read_gradient(w), expected);
}

TEST(ExecutorTest, SharedGroupsSeeEachOther) {
  const auto groups = std::make_shared<GroupStore>(test_device());
  Graph one;
  const Value w1 = one.parameter("p", "w", {3});
  one.keep("y", leaky_relu(w1, 0.1F));
  Graph two;
  const Value w2 = two.parameter("p", "w", {3});
  const Value y2 = leaky_relu(w2, 0.1F);
  two.keep("y", y2);
  Executor first(test_device(), one, {.groups = groups});
  Executor second(test_device(), two, {.groups = groups});
  first.write(w1, std::vector<float>{1, 2, -10});
  second.forward();
  EXPECT_EQ(second.read(y2), (std::vector<float>{1, 2, -1}));
}

TEST(ExecutorTest, TheEndOfAValueMayComeFromTheDevice) {
  Graph graph;
  const Value x = graph.input("x", row_major({4})), y = leaky_relu(x, 1.0F);
  graph.keep("y", y);
  Executor executor(test_device(), graph);
  executor.write(x, std::vector<float>{1, 2, 3, 4});
  Buffer other(test_device(), 20, MemoryKind::kDevice, "other");
  const Slice all = other.whole();
  upload_values<float>(test_device(), all, std::vector<float>{5, 6, 7, 8, 9});
  executor.write_end(x, all.sub(4, 8));
  executor.forward();
  EXPECT_EQ(executor.read(y), (std::vector<float>{1, 2, 6, 7}));
  test::expect_error([&] { executor.write_end(x, all); }, {"20 bytes", "16"});
}

TEST(ExecutorTest, SaysWhatIsWrong) {
  Graph graph;
  const Value x = graph.input("x", row_major({4}));
  const Value hidden = leaky_relu(x, 0.1F);
  graph.keep("y", leaky_relu(hidden, 0.1F));
  Executor executor(test_device(), graph);
  EXPECT_THROW(executor.read(hidden), Error);
  EXPECT_THROW(executor.write(x, std::vector<float>(3)), Error);
  EXPECT_THROW(executor.backward(), Error);
  EXPECT_THROW(graph.input("x", row_major({4})), Error);
  EXPECT_THROW(graph.find("z"), Error);
  EXPECT_THROW(Executor(test_device(), graph, {.loss = graph.find("y"), .trained = {}}), Error);
}

TEST(ExecutorTest, MoreThanThereIsIsRefusedBeforeAnyIsTaken) {
  Graph graph;
  const Value x = graph.input("x", row_major({int64_t{1} << 48}));
  graph.keep("y", leaky_relu(x, 0.9F));
  test::expect_error([&] { const Executor executor(test_device(), graph); },
                     {" GiB of memory are needed", " free", "smaller batch or image size"});
}

TEST(ExecutorTest, IntermediatesShareMemory) {
  Graph graph;
  Value x = graph.input("x", row_major({1 << 16}));
  for (int i = 0; i < 20; ++i) x = leaky_relu(x, 0.9F);
  graph.keep("y", x);
  const Executor executor(test_device(), graph);
  EXPECT_LE(executor.shared_bytes(), 2U << 18);
}

/// A small residual network in which every way of saving memory occurs.
struct Residual {
  Graph graph;
  Value x, loss;

  Residual() {
    x = graph.input("x", channels4({2, 8, 9, 7}));
    const Value random = graph.state("random", "random", unsigned_ints({2}));
    Value h = leaky_relu(x, 0.5F);
    for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
      const Value w = graph.parameter("p", std::string(name) + ".weight", {8, 8, 3, 3});
      const Value gamma = graph.parameter("p", std::string(name) + ".gamma", {8});
      const Value beta = graph.parameter("p", std::string(name) + ".beta", {8});
      const Value mean = graph.state("s", std::string(name) + ".mean", row_major({8}));
      const Value var = graph.state("s", std::string(name) + ".var", row_major({8}));
      const Value y = conv2d(h, w, Value{}, {.padding = 1});
      const BatchNormOptions options{.eps = 0.1F, .slope = 0.1F, .dropout = 0.2F};
      h = add(batch_norm(y, gamma, beta, mean, var, random, options), h);
    }
    loss = image_loss(to_row_major(h), graph.input("target", row_major({2, 8, 9, 7})));
    graph.keep("loss", loss);
  }
};

struct Step {
  std::vector<float> loss, gradient;
  uint64_t shared_bytes;
};

Step step(uint64_t recompute_from, bool in_place) {
  Residual net;
  Executor executor(
      test_device(), net.graph,
      {.loss = net.loss, .trained = {"p"}, .recompute_from = recompute_from, .in_place = in_place});
  std::mt19937 random(5);
  for (const Value& value : {net.x, net.graph.group("p")}) {
    std::vector<float> values(static_cast<size_t>(value.shape().elements()));
    for (float& v : values) v = static_cast<float>(random() % 2001) / 1000 - 1;
    executor.write(value, values);
  }
  executor.write(net.graph.find("target"), std::vector<float>(2 * 8 * 9 * 7, 0.5F));
  executor.write_words(net.graph.find("random"), std::vector<uint32_t>{3, 4});
  executor.forward();
  executor.backward();
  return {executor.read(net.loss), executor.read(net.graph.gradient("p")), executor.shared_bytes()};
}

TEST(ExecutorTest, SavingMemoryChangesNoBit) {
  constexpr uint64_t kNever = ~uint64_t{0};
  const Step plain = step(kNever, false);
  EXPECT_GT(plain.loss[0], 0.0F);
  for (const auto& [recompute_from, in_place] :
       std::vector<std::pair<uint64_t, bool>>{{kNever, true}, {0, false}, {0, true}}) {
    const Step saving = step(recompute_from, in_place);
    EXPECT_EQ(saving.loss, plain.loss);
    EXPECT_EQ(saving.gradient, plain.gradient) << recompute_from << ", " << in_place;
    EXPECT_LT(saving.shared_bytes, plain.shared_bytes) << recompute_from << ", " << in_place;
  }
}

/// The residual network's gradient from backward passes on made-up images with these seeds, `portions` of them
/// for each update. Of the last update.
std::vector<float> portioned_gradient(int portions, const std::vector<uint32_t>& seeds, bool scaled = false) {
  Residual net;
  const Value scale = scaled ? net.graph.state("scale", "scale", row_major({4})) : Value{};
  Executor executor(test_device(), net.graph,
                    {.loss = net.loss, .trained = {"p"}, .loss_scale = scale, .portions = portions});
  const auto fill = [&](const Value& value, uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<float> values(static_cast<size_t>(value.shape().elements()));
    for (float& v : values) v = static_cast<float>(random() % 2001) / 1000 - 1;
    executor.write(value, values);
  };
  fill(net.graph.group("p"), 5);
  if (scaled) executor.write(scale, std::vector<float>{8, 0, 0, 0});
  executor.write_words(net.graph.find("random"), std::vector<uint32_t>{3, 4});
  for (size_t i = 0; i < seeds.size(); ++i) {
    fill(net.x, seeds[i]);
    fill(net.graph.find("target"), seeds[i] + 100);
    executor.forward();
    executor.backward(i % static_cast<size_t>(portions) == 0 ? Portion::kFirst : Portion::kLater);
  }
  return executor.read(net.graph.gradient("p"));
}

TEST(ExecutorTest, GradientsOfPortionsAreTheirMean) {
  const auto one = portioned_gradient(1, {1}), two = portioned_gradient(1, {2}),
             three = portioned_gradient(1, {3});
  const auto all = portioned_gradient(3, {1, 2, 3}), scaled = portioned_gradient(3, {1, 2, 3}, true);
  double largest = 0;
  for (const float v : one) largest = std::max(largest, std::fabs(double{v}));
  ASSERT_GT(largest, 1);
  for (size_t i = 0; i < all.size(); ++i) {
    const double mean = (double{one[i]} + double{two[i]} + double{three[i]}) / 3;
    EXPECT_NEAR(all[i], mean, 1e-6 * largest) << i;
    EXPECT_NEAR(scaled[i], 8 * mean, 8e-6 * largest) << i;
  }
}

TEST(ExecutorTest, GradientsOfTheNextPortionsTakeThePlaceOfTheLast) {
  EXPECT_EQ(portioned_gradient(2, {3, 3, 1, 2}), portioned_gradient(2, {1, 2}));
}

}  // namespace
}  // namespace vkopple
