#include "models/slot_counters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "graph/executor.h"
#include "models/perception_graph.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"

namespace vkopple {
namespace {

constexpr int kImages = 2, kSlots = 4;

/// The squared distance of two slots' identity codes in two different images, as they are before training.
double squared_distance(int counters, int slot_a, int image_a, int slot_b, int image_b) {
  ModelConfig config = test::tiny_config().model;
  config.slots = kSlots;
  config.slot_counters = counters;
  config.lstm = 16;
  Graph graph;
  const PerceptionGraph made = perception_graph(graph, config, kImages, true);
  Executor executor(test_device(), graph, {});
  for (const InitialTensor& t : made.tensors)
    executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 3, t.name));
  std::vector<float> images(static_cast<size_t>(made.images.shape().elements()));
  for (size_t i = 0; i < images.size(); ++i) images[i] = static_cast<float>(i * i % 23) / 23;
  executor.write(made.images, images);
  executor.forward();
  const std::vector<float> codes = executor.read(made.objects.code);
  const auto component = [&](int image, int slot, int i) {
    return codes.at(static_cast<size_t>((image * kSlots + slot) * config.code + i));
  };
  double sum = 0;
  for (int i = 0; i < config.identity; ++i)
    sum += std::pow(component(image_a, slot_a, i) - component(image_b, slot_b, i), 2);
  return sum;
}

TEST(SlotCountersTest, TheIdentityCodeIsTheSlotsNumber) {
  for (int slot = 0; slot < kSlots; ++slot) {
    EXPECT_LT(squared_distance(kSlots - 1, slot, 0, slot, 1), 1e-4) << slot;
    for (int other = 0; other < slot; ++other)
      EXPECT_NEAR(squared_distance(kSlots - 1, slot, 0, other, 1), 3.33 * 3.33 * (slot - other), 0.5)
          << slot << " " << other;
  }
}

TEST(SlotCountersTest, WithoutThemSlotsAreNearlyTheSame) { EXPECT_LT(squared_distance(0, 1, 0, 2, 0), 0.3); }

}  // namespace
}  // namespace vkopple
