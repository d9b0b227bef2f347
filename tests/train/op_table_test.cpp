#include "train/op_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_device.h"
#include "train/peak.h"

namespace vkopple {
namespace {

NodeProfile node(const std::string& op, const TensorSpec& x, const TensorSpec& w, const TensorSpec& y,
                 double begin, double end) {
  return {.op = op,
          .scope = "here",
          .inputs = {x, w},
          .outputs = {y},
          .flop = 2e9,
          .bytes = 1000,
          .commands = {{"kernel", 0, begin, (begin + end) / 2}, {"kernel", 0, (begin + end) / 2, end}}};
}

/// Two convolutions of one shape, one of another, and the first ones' backward pass.
std::vector<PassProfile> made_up() {
  const TensorSpec x = channels4({2, 8, 16, 16}), w = row_major({12, 8, 3, 3}), half = channels4({2, 12, 8, 8}),
                   same = channels4({2, 12, 16, 16});
  return {{.name = "forward",
           .host = {},
           .nodes = {node("conv2d", x, w, same, 0, 1), node("conv2d", x, w, half, 1, 2),
                     node("conv2d", x, w, same, 2, 4)}},
          {.name = "backward", .host = {}, .nodes = {node("conv2d", x, w, same, 0, 6)}}};
}

TEST(OpTableTest, TakesEqualShapesTogetherLongestFirst) {
  const auto rows = op_table(made_up(), OpRows::kByShape);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].pass, "backward");
  EXPECT_DOUBLE_EQ(rows[0].share, 0.6);
  EXPECT_EQ(rows[1].shape, "3x3 s1 (2, 8, 16, 16) -> 12");
  EXPECT_EQ(rows[1].count, 2U);
  EXPECT_DOUBLE_EQ(rows[1].seconds, 3);
  EXPECT_DOUBLE_EQ(rows[1].gflops(), 4.0 / 3);
  EXPECT_DOUBLE_EQ(rows[1].gbytes, 2e-6);
  EXPECT_EQ(rows[2].shape, "3x3 s2 (2, 8, 16, 16) -> 12");
}

TEST(OpTableTest, ByOpLeavesShapesOut) {
  const auto rows = op_table(made_up(), OpRows::kByOp);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].count, 3U);
  EXPECT_EQ(rows[1].shape, "");
  EXPECT_DOUBLE_EQ(rows[0].share + rows[1].share, 1);
}

TEST(OpTableTest, ShapesOfOtherOps) {
  NodeProfile linear{
      .op = "linear", .inputs = {row_major({4, 7}), row_major({9, 7})}, .outputs = {row_major({4, 9})}};
  EXPECT_EQ(shape_text(linear), "(4, 7) -> (4, 9)");
  NodeProfile twice =
      node("conv_transpose2d", channels4({2, 8, 4, 4}), row_major({8, 6, 2, 2}), channels4({2, 6, 8, 8}), 0, 1);
  EXPECT_EQ(shape_text(twice), "2x2 t2 (2, 8, 4, 4) -> 6");
  EXPECT_EQ(shape_text({.op = "fill"}), "");
}

TEST(PeakTest, IsANumberOfMultiplyAdds) {
  const double peak = measure_peak_gflops(test_device());
  EXPECT_TRUE(std::isfinite(peak));
  EXPECT_GT(peak, 0.1);
}

}  // namespace
}  // namespace vkopple
