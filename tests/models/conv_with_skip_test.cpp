#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "graph/executor.h"
#include "models/layers.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

constexpr int64_t kSamples = 2;

/// A convolution of a skip and as many samples on a device that binds so much; no tensor is larger.
std::vector<float> convolved(uint64_t max_tensor_bytes) {
  Graph graph;
  LayerFactory layers(graph, {.group = "test", .max_tensor_bytes = max_tensor_bytes});
  const TensorSpec spec = channels4({kSamples, 4, 5, 6});
  const Value skip = graph.input("skip", spec);
  const Value x = graph.input("x", spec);
  const Value y = layers.conv_with_skip(skip, x, "conv", 4, 0);
  graph.keep("y", y);
  for (const Node& node : graph.nodes())
    for (const int id : node.outputs)
      EXPECT_LE(graph.info(id).spec.bytes(), max_tensor_bytes) << node.op->name();
  Executor executor(test_device(), graph);
  for (const InitialTensor& t : layers.tensors())
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 3, t.name));
  std::vector<float> values(static_cast<size_t>(spec.shape.elements()));
  for (size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<float>(i));
  executor.write(x, values);
  std::reverse(values.begin(), values.end());
  executor.write(skip, values);
  executor.forward();
  return executor.read(y);
}

TEST(ConvWithSkipTest, IsTakenApartWhereTheDeviceCantBindBothAsOne) {
  const auto joined = convolved(~uint64_t{0});
  const auto apart = convolved(channels4({kSamples, 4, 5, 6}).bytes());
  ASSERT_EQ(joined.size(), apart.size());
  for (size_t i = 0; i < joined.size(); ++i) EXPECT_NEAR(joined[i], apart[i], 1e-5) << i;
}

TEST(ConvWithSkipTest, ComputesTheSkipsPartOnceForSeveralCalls) {
  Graph graph;
  LayerFactory layers(graph, {.group = "test"});
  const TensorSpec spec = channels4({kSamples, 4, 5, 6});
  const Value skip = graph.input("skip", spec);
  for (const char* name : {"x", "y", "z"})
    graph.keep(std::string("out ") + name,
               layers.conv_with_skip(skip, graph.input(name, spec), "conv", 4, kSamples));
  EXPECT_EQ(std::count_if(graph.nodes().begin(), graph.nodes().end(),
                          [](const Node& node) { return node.op->name() == "conv2d"; }),
            1 + 3);
}

}  // namespace
}  // namespace vkopple
