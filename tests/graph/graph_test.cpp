#include "graph/graph.h"

#include <gtest/gtest.h>

#include "graph/ops/leaky_relu.h"

namespace vkopple {
namespace {

// Code that builds networks keeps `const Shape&` of a value while it adds others.
TEST(Graph, ShapesStayWhereTheyAreWhileTheGraphGrows) {
  Graph graph;
  Value value = graph.input("x", row_major({3, 5}));
  const Shape* const shape = &value.shape();
  const ValueInfo* const info = &graph.info(value.id());
  for (int i = 0; i < 1000; ++i) value = leaky_relu(value, 0.1F);
  EXPECT_EQ(shape, &graph.find("x").shape());
  EXPECT_EQ(info, &graph.info(graph.find("x").id()));
  EXPECT_EQ(*shape, (Shape{3, 5}));
}

}  // namespace
}  // namespace vkopple
