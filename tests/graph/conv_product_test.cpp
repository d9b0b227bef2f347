#include "graph/conv/conv_product.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "graph/conv/conv_tile.h"
#include "graph/tensor.h"
#include "runtime/error.h"
#include "runtime/transfer.h"
#include "tests/support/conv_reference.h"
#include "tests/support/guarded.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

using Values = std::vector<float>;
using test::each_product;

struct Problem {
  ConvShape shape;
  ConvDirection direction;
  TensorSpec in, w, bias, out;

  Problem(const ConvShape& s, ConvDirection d)
      : shape(s), direction(d), w(row_major({s.co, s.ci, s.kernel, s.kernel})) {
    const bool forward = d == ConvDirection::kForward;
    const TensorSpec x = channels4({s.n, s.ci, s.h, s.w});
    const TensorSpec y = channels4({s.n, s.co, s.ho, s.wo});
    in = forward ? x : y;
    out = forward ? y : x;
    bias = row_major({out.shape[1]});
  }
};

Values draw(const TensorSpec& spec, uint32_t seed) {
  std::mt19937 random(seed);
  Values values(static_cast<size_t>(spec.shape.elements()));
  for (float& v : values) v = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
  return values;
}

std::vector<double> expected(const Problem& p, const Values& in, const Values& w, const Values& bias,
                             const Values& before) {
  std::vector<double> out(before.begin(), before.end());
  const auto plane = static_cast<size_t>(p.out.shape[2] * p.out.shape[3]);
  for (size_t i = 0; i < out.size(); ++i) out[i] += static_cast<double>(bias[i / plane % bias.size()]);
  each_product(p.shape, [&](int64_t x, int64_t wi, int64_t y) {
    const bool forward = p.direction == ConvDirection::kForward;
    out[static_cast<size_t>(forward ? y : x)] += static_cast<double>(in[static_cast<size_t>(forward ? x : y)]) *
                                                 static_cast<double>(w[static_cast<size_t>(wi)]);
  });
  return out;
}

void check_problem(const Device& device, const Problem& p, const std::string& kernel) {
  SCOPED_TRACE(fmt::format("{} {} -> {} kernel {} stride {}", kernel, p.in.shape.text(), p.out.shape.text(),
                           p.shape.kernel, p.shape.stride));
  const Values in = draw(p.in, 1);
  const Values w = draw(p.w, 2);
  const Values bias = draw(p.bias, 3);
  const Values before = draw(p.out, 4);
  GuardedMemory memory(device);
  const auto place = [&](const TensorSpec& spec, const Values& values) {
    const Slice slice = memory.allocate(spec.bytes(), "an operand");
    upload_values<float>(device, slice, to_layout(spec, values));
    return slice;
  };
  const ConvOperands operands{.in = place(p.in, in),
                              .w = place(p.w, w),
                              .bias = place(p.bias, bias),
                              .out = place(p.out, before),
                              .accumulate = 1};
  Recorder recorder(device, false, Bounds::kGuarded);
  record_conv_product(recorder, p.shape, p.direction, operands,
                      memory.allocate(conv_product_scratch(p.shape, p.direction), "scratch"), kernel);
  test::run_guarded(recorder, memory);
  const Values got = from_layout(p.out, download_values<float>(device, operands.out));
  const std::vector<double> want = expected(p, in, w, bias, before);
  double worst = 0;
  for (size_t i = 0; i < want.size(); ++i) {
    const double d = std::abs(static_cast<double>(got[i]) - want[i]);
    if (!(d <= worst)) worst = d;
  }
  EXPECT_LE(worst, 1e-4);
}

/// Shapes of several tiles in every direction, which finite differences would take too long over.
TEST(ConvProductTest, MatchesPlainLoopsOverManyTiles) {
  const std::vector<ConvShape> shapes{
      {.n = 3,
       .ci = 20,
       .h = 17,
       .w = 19,
       .co = 72,
       .ho = 17,
       .wo = 19,
       .kernel = 3,
       .stride = 1,
       .padding = 1,
       .dilation = 1},
      {.n = 2,
       .ci = 37,
       .h = 21,
       .w = 33,
       .co = 16,
       .ho = 11,
       .wo = 17,
       .kernel = 3,
       .stride = 2,
       .padding = 1,
       .dilation = 1},
      {.n = 2,
       .ci = 12,
       .h = 30,
       .w = 26,
       .co = 6,
       .ho = 15,
       .wo = 13,
       .kernel = 2,
       .stride = 2,
       .padding = 0,
       .dilation = 1},
      {.n = 5,
       .ci = 3,
       .h = 23,
       .w = 29,
       .co = 64,
       .ho = 23,
       .wo = 29,
       .kernel = 3,
       .stride = 1,
       .padding = 2,
       .dilation = 2},
      {.n = 4,
       .ci = 4,
       .h = 40,
       .w = 9,
       .co = 1,
       .ho = 40,
       .wo = 9,
       .kernel = 3,
       .stride = 1,
       .padding = 1,
       .dilation = 1},
      {.n = 7,
       .ci = 65,
       .h = 1,
       .w = 1,
       .co = 130,
       .ho = 1,
       .wo = 1,
       .kernel = 3,
       .stride = 1,
       .padding = 1,
       .dilation = 1},
      {.n = 2,
       .ci = 40,
       .h = 9,
       .w = 32,
       .co = 40,
       .ho = 9,
       .wo = 32,
       .kernel = 3,
       .stride = 1,
       .padding = 1,
       .dilation = 1},
      {.n = 3,
       .ci = 6,
       .h = 10,
       .w = 32,
       .co = 24,
       .ho = 5,
       .wo = 16,
       .kernel = 3,
       .stride = 2,
       .padding = 1,
       .dilation = 1},
  };
  for (const ConvShape& shape : shapes)
    for (const ConvDirection direction : {ConvDirection::kForward, ConvDirection::kTransposed})
      for (const std::string kernel : {"shuffle", "window", "uniform", "shared"}) {
        if (kernel == "window" && shape.dilation > 1) continue;
        if (!can_run_conv_kernel(kernel, test_device().caps())) {
          std::cout << "left out, the device can't run: " << kernel << "\n";
          continue;
        }
        check_problem(test_device(), Problem(shape, direction), kernel);
      }
}

TEST(ConvProductTest, ADeviceWithoutShufflesIsRefusedThem) {
  Caps caps;
  caps.subgroup_shuffle = false;
  caps.subgroup_size = 32;
  EXPECT_FALSE(can_run_conv_kernel("shuffle", caps));
  EXPECT_TRUE(can_run_conv_kernel("uniform", caps));
  caps.subgroup_shuffle = true;
  EXPECT_TRUE(can_run_conv_kernel("shuffle", caps));
  caps.subgroup_size = 4;  // fewer lanes than the weights of 8 output channels
  EXPECT_FALSE(can_run_conv_kernel("shuffle", caps));
  EXPECT_FALSE(is_conv_kernel("winograd"));
}

TEST(ConvProductTest, TilesGrowWithTheImageAndShrinkToItsChannels) {
  const auto tile = [](int64_t pixels, int64_t channels) {
    return choose_shuffle_tile({.pixels = pixels, .out_channels = channels, .in4 = 16, .taps = 9, .lanes = 8},
                               2);
  };
  EXPECT_EQ(tile(65536, 64).out4, 8);
  EXPECT_EQ(tile(65536, 64).pixels, 8);
  EXPECT_EQ(tile(65536, 8).out4, 2);
  EXPECT_EQ(tile(65536, 3).out4, 1);
  EXPECT_LE(tile(4, 256).pixels, 2);
}

}  // namespace
}  // namespace vkopple
