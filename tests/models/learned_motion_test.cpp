#include "models/learned_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graph/executor.h"
#include "graph/ops/binary.h"
#include "graph/ops/reduce_sum.h"
#include "models/camera_motion.h"
#include "models/network_options.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

constexpr int64_t kBatch = 3;
constexpr int64_t kSlots = 2;
constexpr int64_t kHeight = 5;
constexpr int64_t kWidth = 6;

std::vector<float> numbers(int64_t count, float step) {
  std::vector<float> values;
  for (int64_t i = 0; i < count; ++i) values.push_back(std::sin(step * static_cast<float>(i)));
  return values;
}

struct Moved {
  std::vector<float> points;
  std::vector<float> dpoints;
  size_t nodes;
};

Moved moved(uint64_t max_tensor_bytes) {
  Graph graph;
  LayerFactory layers(graph, network_options({}, "motion", false, {}, max_tensor_bytes));
  const Value points = graph.parameter("points", "points", {kBatch, 3, kHeight, kWidth});
  const Value objects = graph.input("objects", row_major({kBatch, kSlots, kPixelMotionNumbers}));
  const Value still = graph.input("still", row_major({kBatch, 1, kPixelMotionNumbers}));
  const Value result = learned_pixels(layers, objects, still, points);
  graph.keep("result", result);
  const Value loss = reduce_sum(mul(result, graph.input("w", result.spec())), {0, 1, 2, 3, 4});
  Executor executor(test_device(), graph, {.loss = loss, .trained = {"points"}});
  for (const InitialTensor& t : layers.tensors())
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 5, t.name));
  executor.write(points, numbers(points.shape().elements(), 0.7F));
  executor.write(objects, numbers(objects.shape().elements(), 1.3F));
  executor.write(still, numbers(still.shape().elements(), 0.4F));
  executor.write(graph.find("w"), numbers(result.shape().elements(), 2.1F));
  executor.forward();
  executor.backward();
  return {executor.read(result), executor.read_gradient(points), graph.nodes().size()};
}

// Where the device can't bind the widest layer of all images at once, they go in parts, to the same numbers.
TEST(LearnedMotionTest, ImagesGoInPartsWhereTensorsWouldBeTooLarge) {
  const Moved at_once = moved(~uint64_t{0});
  const uint64_t of_an_image = channels4({kSlots, 64, kHeight, kWidth}).bytes();
  for (const uint64_t most : {of_an_image, 2 * of_an_image, uint64_t{1}}) {
    const Moved in_parts = moved(most);
    EXPECT_GT(in_parts.nodes, at_once.nodes);
    EXPECT_EQ(in_parts.points, at_once.points);
    EXPECT_EQ(in_parts.dpoints, at_once.dpoints);
  }
}

}  // namespace
}  // namespace vkopple
