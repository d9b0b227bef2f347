#include "graph/executor.h"

#include <gtest/gtest.h>

#include "graph/ops/concat.h"
#include "graph/ops/leaky_relu.h"
#include "graph/ops/slice.h"
#include "runtime/error.h"
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

TEST(ExecutorTest, IntermediatesShareMemory) {
  Graph graph;
  Value x = graph.input("x", row_major({1 << 16}));
  for (int i = 0; i < 20; ++i) x = leaky_relu(x, 0.9F);
  graph.keep("y", x);
  const Executor executor(test_device(), graph);
  EXPECT_LE(executor.shared_bytes(), 2U << 18);
}

}  // namespace
}  // namespace vkopple
