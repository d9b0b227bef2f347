#include "graph/op.h"

#include <gtest/gtest.h>

#include "tests/support/test_device.h"

namespace vkopple {
namespace {

TEST(BackwardTest, MasksSpeakOfTheFirst32Inputs) {
  Buffer buffer(test_device(), 256, MemoryKind::kDevice, "gradient");
  std::vector<Operand> dx(34);
  std::vector<uint8_t> accumulate(34);
  for (const size_t i : {size_t{1}, size_t{31}, size_t{33}}) dx[i].slice = {&buffer, 0, 4};
  for (const size_t i : {size_t{0}, size_t{31}, size_t{32}}) accumulate[i] = 1;
  const Backward io{{}, {}, {}, {}, dx, accumulate, {}};
  EXPECT_EQ(io.wants_mask(), 1U << 1 | 1U << 31);
  EXPECT_EQ(io.accumulates_mask(), 1U << 0 | 1U << 31);
  EXPECT_EQ((Backward{{}, {}, {}, {}, std::span(dx).first(3), std::span(accumulate).first(3), {}}.wants_mask()),
            2U);
}

}  // namespace
}  // namespace vkopple
