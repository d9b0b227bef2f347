#include "graph/ops/move_pixels.h"

#include <gtest/gtest.h>

#include "graph/graph.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// Of 2 images of 4 x 5 pixels and 3 slots.
Shape moved_by(const Shape& turns) {
  Graph graph;
  const auto input = [&](const std::string& name, const Shape& shape) {
    return graph.input(name, row_major(shape));
  };
  return move_pixels(input("points", {2, 3, 4, 5}), input("location", {2, 3, 3}), input("velocity", {2, 3, 3}),
                     input("turns", turns), input("m23", {2, 4, 4}))
      .shape();
}

TEST(MovePixelsTest, TakesAnglesOrMatricesAndNothingElse) {
  const Shape moved{2, 4, 3, 4, 5};
  EXPECT_EQ(moved_by({2, 3}), moved);
  EXPECT_EQ(moved_by({2, 3, 3, 3}), moved);
  for (const Shape& turns :
       {Shape{2}, Shape{3, 3}, Shape{2, 4}, Shape{2, 3, 3}, Shape{2, 3, 4, 3}, Shape{2, 3, 3, 4}})
    EXPECT_THROW(moved_by(turns), Error) << turns.text();
}

}  // namespace
}  // namespace vkopple
