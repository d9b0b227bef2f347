#include "models/mask_window.h"

#include <gtest/gtest.h>

#include <vector>

#include "graph/executor.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

// Two slots in two images of 1 x 2 pixels.
TEST(MaskWindow, FallsWithTheDistanceFromTheSlotsLocation) {
  Graph graph;
  const Value logits = graph.input("logits", row_major({2, 2, 1, 2}));
  const Value points = graph.input("points", row_major({2, 3, 1, 2}));
  const Value location = graph.input("location", row_major({2, 2, 3}));
  const Value windowed = mask_window(logits, points, location, 0.5);
  graph.keep("windowed", windowed);
  Executor executor(test_device(), graph, {});
  executor.write(logits, std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7});
  // Image 0: (0, 1, 0) and (1, 1, 0). Image 1: (0, 2, -1) and (0, 3, 0).
  executor.write(points, std::vector<float>{0, 1, 1, 1, 0, 0, 0, 0, 2, 3, -1, 0});
  // Image 0: slots at (0, 1, 0) and (1, 2, 0). Image 1: at (0, 3, 0) and (0, 2, 1).
  executor.write(location, std::vector<float>{0, 1, 0, 1, 2, 0, 0, 3, 0, 0, 2, 1});
  executor.forward();
  // Squared distances, slot by slot: 0, 1 and 2, 0 in the first; 2, 1 and 4, 2 in the second. The factor is -2.
  EXPECT_EQ(executor.read(windowed), (std::vector<float>{0, 1 - 2, 2 - 4, 3, 4 - 4, 5 - 2, 6 - 8, 7 - 4}));
}

}  // namespace
}  // namespace vkopple
