#include "models/object_net.h"

#include <gtest/gtest.h>

#include <vector>

#include "graph/executor.h"
#include "models/initialise.h"
#include "models/perception_graph.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"

namespace vkopple {
namespace {

std::vector<float> masks(uint64_t max_tensor_bytes) {
  ModelConfig config = test::tiny_config().model;
  config.slots = 7;
  config.height = 16;
  config.width = 16;
  Graph graph;
  const PerceptionGraph made = perception_graph(graph, config, 2, true, max_tensor_bytes);
  Executor executor(test_device(), graph, {});
  for (const InitialTensor& t : made.tensors)
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 3, t.name));
  std::vector<float> images(static_cast<size_t>(made.images.shape().elements()));
  for (size_t i = 0; i < images.size(); ++i) images[i] = static_cast<float>(i % 17) / 17;
  executor.write(made.images, images);
  executor.forward();
  return executor.read(made.objects.masks);
}

// One slot after the other, more of them than a concatenation of channels takes.
TEST(ObjectNetTest, DecodesManySlotsOneByOneWhereTheyDontFitTogether) {
  const std::vector<float> together = masks(~uint64_t{0});
  const std::vector<float> apart = masks(1);
  ASSERT_EQ(apart.size(), together.size());
  for (size_t i = 0; i < apart.size(); ++i) ASSERT_NEAR(apart[i], together[i], 1e-6) << i;
}

}  // namespace
}  // namespace vkopple
