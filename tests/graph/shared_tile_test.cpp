#include "graph/conv/shared_tile.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "graph/conv/conv_product.h"
#include "graph/conv/weight_gradient.h"
#include "graph/tensor.h"
#include "tests/support/gpu_caps.h"

namespace vkopple {
namespace {

using test::each_gpu;
using test::gpu_caps;

const std::vector<ConvShape>& shapes() {
  static const std::vector<ConvShape> all{{1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1},
                                          {60, 3, 128, 128, 16, 128, 128, 3, 1, 1, 1},
                                          {20, 64, 128, 128, 64, 128, 128, 3, 1, 1, 1},
                                          {4, 256, 8, 8, 256, 8, 8, 3, 1, 1, 1},
                                          {4, 640, 16, 16, 128, 16, 16, 1, 1, 0, 1},
                                          {1, 37, 33, 17, 1000, 17, 9, 3, 2, 1, 1},
                                          {20, 16, 256, 256, 1, 256, 256, 3, 1, 1, 1}};
  return all;
}

TEST(SharedTile, EveryChoiceFitsTheDevice) {
  each_gpu([](const Caps& caps) {
    for (const ConvShape& s : shapes()) {
      const SharedTile tile = choose_shared_tile(
          {.pixels = s.n * s.ho * s.wo, .phases = 1, .out4 = blocks4(s.co), .in4 = blocks4(s.ci)}, caps);
      EXPECT_TRUE(fits(tile, caps)) << tile.invocations() << " invocations, " << tile.shared_bytes()
                                    << " bytes";
      EXPECT_LE(tile.invocations(), caps.max_workgroup_size);
      EXPECT_LE(tile.shared_bytes(), caps.shared_memory_bytes);
      const SharedGradientTile gradient =
          choose_shared_gradient_tile({.pixels = s.n * s.ho * s.wo,
                                       .rows4 = blocks4(s.co),
                                       .columns4 = s.kernel * s.kernel * blocks4(s.ci)},
                                      caps);
      EXPECT_TRUE(fits(gradient, caps));
      EXPECT_LE(gradient.invocations(), caps.max_workgroup_size);
      EXPECT_LE(gradient.shared_bytes(), caps.shared_memory_bytes);
    }
  });
}

TEST(SharedTile, GrowsWithTheWorkAndTheDevice) {
  const Caps least = gpu_caps(128, 16384, 32);
  const Caps large = gpu_caps(1024, 49152, 32);
  const SharedWork big{.pixels = 327680, .phases = 1, .out4 = 64, .in4 = 16};
  const SharedWork small{.pixels = 256, .phases = 1, .out4 = 64, .in4 = 64};
  const auto area = [](const SharedTile& t) { return t.tile_pixels() * t.tile_channels(); };
  EXPECT_GT(area(choose_shared_tile(big, large)), area(choose_shared_tile(big, least)));
  EXPECT_LT(area(choose_shared_tile(small, large)), area(choose_shared_tile(big, large)));
  // No more channels than there are, and no depth beyond the input's.
  EXPECT_EQ(choose_shared_tile({.pixels = 327680, .phases = 1, .out4 = 1, .in4 = 16}, large).tile_channels(),
            4U);
  EXPECT_EQ(choose_shared_tile({.pixels = 327680, .phases = 1, .out4 = 16, .in4 = 1}, large).depth, 1U);
}

TEST(SharedTile, WhatTheKernelCannotDoIsNone) {
  const SharedTile good{2, 4, 16, 8, 2};
  EXPECT_TRUE(is_shared_tile(good));
  for (uint32_t SharedTile::*member :
       {&SharedTile::out4, &SharedTile::pixels, &SharedTile::across, &SharedTile::down, &SharedTile::depth})
    for (uint32_t value : {0U, 3U, 64U * 1024U, 0x80000000U, 0xFFFFFFFFU}) {
      SharedTile bad = good;
      bad.*member = value;
      EXPECT_FALSE(is_shared_tile(bad)) << value;
      EXPECT_FALSE(fits(bad, gpu_caps(1024, 1U << 30, 32)));
    }
  EXPECT_FALSE(is_shared_tile(SharedTile{8, 8, 8, 8, 2}));          // 256 sums
  EXPECT_FALSE(is_shared_tile(SharedGradientTile{1, 1, 2, 2, 8}));  // fewer invocations than pixels of a slab
  EXPECT_FALSE(is_shared_tile(SharedGradientTile{4, 2, 8, 8, 8}));  // 128 sums
  EXPECT_FALSE(is_shared_tile(SharedGradientTile{1, 1, 8, 24, 8}));
  EXPECT_TRUE(is_shared_tile(SharedGradientTile{1, 1, 8, 8, 8}));
  EXPECT_FALSE(fits(SharedTile{2, 8, 16, 16, 2}, gpu_caps(128, 65536, 64)));
  EXPECT_FALSE(fits(SharedTile{2, 4, 64, 1, 2}, gpu_caps(1024, 16384, 64)));
}

TEST(SharedTile, EveryCandidateIsRight) {
  for (const SharedTile& tile : shared_tiles()) EXPECT_TRUE(is_shared_tile(tile));
  for (const SharedGradientTile& tile : shared_gradient_tiles()) EXPECT_TRUE(is_shared_tile(tile));
}

TEST(KernelFamily, GpusTakeSharedMemoryAndRefuseRegisters) {
  Caps caps = gpu_caps(128, 16384, 32);
  caps.subgroup_shuffle = true;
  EXPECT_TRUE(missing_for(KernelFamily::kShared, caps).empty());
  EXPECT_TRUE(missing_for(KernelFamily::kPlain, caps).empty());
  EXPECT_NE(missing_for(KernelFamily::kRegisters, caps).find("made up"), std::string::npos);
  EXPECT_EQ(missing_for(KernelFamily::kRegisters, caps).find('\n'), std::string::npos);
  EXPECT_TRUE(can_run_conv_kernel("shared", caps));
  // The second stage's partial sums tell the families apart.
  const ConvShape shape{4, 16, 32, 32, 16, 32, 32, 3, 1, 1, 1};
  EXPECT_EQ(weight_gradient_scratch(shape, caps),
            weight_gradient_scratch(shape, caps, WeightGradientKernel::kShared));
  caps.kernels = KernelFamily::kPlain;
  EXPECT_EQ(weight_gradient_scratch(shape, caps),
            weight_gradient_scratch(shape, caps, WeightGradientKernel::kSimple));
  EXPECT_NE(weight_gradient_scratch(shape, caps),
            weight_gradient_scratch(shape, caps, WeightGradientKernel::kShared));
}

}  // namespace
}  // namespace vkopple
