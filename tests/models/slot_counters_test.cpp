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

/// Identity codes of slots in images, as they are before training.
class Codes {
 public:
  explicit Codes(int counters) {
    config_.slots = kSlots;
    config_.slot_counters = counters;
    config_.lstm = 16;
    Graph graph;
    const PerceptionGraph made = perception_graph(graph, config_, kImages, true);
    Executor executor(test_device(), graph, {});
    for (const InitialTensor& t : made.tensors)
      executor.write(t.value, initial_values(t.initial, t.value.shape().elements(), 3, t.name));
    std::vector<float> images(static_cast<size_t>(made.images.shape().elements()));
    for (size_t i = 0; i < images.size(); ++i) images[i] = static_cast<float>(i * i % 23) / 23;
    executor.write(made.images, images);
    executor.forward();
    values_ = executor.read(made.objects.code);
  }

  /// Of the codes of two slots, each in an image.
  double squared_distance(int slot_a, int image_a, int slot_b, int image_b) const {
    double sum = 0;
    for (int i = 0; i < config_.identity; ++i)
      sum += std::pow(component(image_a, slot_a, i) - component(image_b, slot_b, i), 2);
    return sum;
  }

 private:
  float component(int image, int slot, int i) const {
    return values_.at(static_cast<size_t>((image * kSlots + slot) * config_.code + i));
  }

  ModelConfig config_ = test::tiny_config().model;
  std::vector<float> values_;
};

TEST(SlotCountersTest, TheIdentityCodeIsTheSlotsNumber) {
  const Codes codes(kSlots - 1);
  for (int slot = 0; slot < kSlots; ++slot) {
    EXPECT_LT(codes.squared_distance(slot, 0, slot, 1), 1e-4) << slot;
    for (int other = 0; other < slot; ++other)
      EXPECT_NEAR(codes.squared_distance(slot, 0, other, 1), 3.33 * 3.33 * (slot - other), 0.5)
          << slot << " " << other;
  }
}

TEST(SlotCountersTest, WithoutThemSlotsAreNearlyTheSame) {
  EXPECT_LT(Codes(0).squared_distance(1, 0, 2, 0), 0.3);
}

}  // namespace
}  // namespace vkopple
