#include "graph/conv/cooperative_tile.h"

#include <gtest/gtest.h>

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_tuning.h"
#include "graph/conv/weight_gradient.h"
#include "graph/tensor.h"
#include "runtime/cooperative_matrix.h"
#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

constexpr CooperativeUse kUses[] = {CooperativeUse::kProduct, CooperativeUse::kWeightGradient};

Caps gpu(std::vector<MatrixShape> shapes, uint32_t invocations = 1024, uint32_t shared_bytes = 49152,
         uint32_t subgroup = 32) {
  Caps caps;
  caps.name = "made up";
  caps.type = DeviceType::kDiscrete;
  caps.max_workgroup_size = invocations;
  caps.shared_memory_bytes = shared_bytes;
  caps.subgroup_size = subgroup;
  caps.max_groups = {65535, 65535, 65535};
  caps.cooperative_matrices = std::move(shapes);
  return caps;
}

const std::vector<MatrixShape> kUsual{{16, 16, 16}, {16, 8, 16}, {16, 8, 8}};
const ConvShape kShape{4, 64, 32, 32, 64, 32, 32, 3, 1, 1, 1};

VkCooperativeMatrixPropertiesKHR offer(uint32_t m, uint32_t n, uint32_t k) {
  VkCooperativeMatrixPropertiesKHR p{};
  p.MSize = m;
  p.NSize = n;
  p.KSize = k;
  p.AType = p.BType = VK_COMPONENT_TYPE_FLOAT16_KHR;
  p.CType = p.ResultType = VK_COMPONENT_TYPE_FLOAT32_KHR;
  p.scope = VK_SCOPE_SUBGROUP_KHR;
  return p;
}

TEST(CooperativeMatrix, OnlyFloat16AddedInFloat32BySubgroupsSuits) {
  std::vector<VkCooperativeMatrixPropertiesKHR> offered(7, offer(16, 16, 16));
  offered[0].ResultType = VK_COMPONENT_TYPE_FLOAT16_KHR;
  offered[1].CType = VK_COMPONENT_TYPE_FLOAT16_KHR;
  offered[2].AType = VK_COMPONENT_TYPE_FLOAT32_KHR;
  offered[3].BType = static_cast<VkComponentTypeKHR>(3);  // 8-bit integers
  offered[4].scope = static_cast<VkScopeKHR>(2);          // workgroups
  offered[5].saturatingAccumulation = VK_TRUE;
  offered.push_back(offer(16, 8, 8));
  offered.push_back(offer(12, 16, 16));
  offered.push_back(offer(16, 16, 4));
  EXPECT_EQ(suitable_shapes(offered), (std::vector<MatrixShape>{{16, 16, 16}, {16, 8, 8}}));
  EXPECT_TRUE(suitable_shapes({}).empty());
}

TEST(CooperativeTile, EveryChoiceFitsTheDevice) {
  const std::vector<ConvShape> shapes{{1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1},
                                      {60, 3, 128, 128, 16, 128, 128, 3, 1, 1, 1},
                                      {20, 64, 128, 128, 64, 128, 128, 3, 1, 1, 1},
                                      {4, 640, 16, 16, 128, 16, 16, 1, 1, 0, 1}};
  for (const uint32_t subgroup : {8U, 16U, 32U, 64U})
    for (const uint32_t invocations : {128U, 256U, 1024U})
      for (const uint32_t bytes : {16384U, 32768U, 65536U})
        for (const MatrixShape& matrix :
             {MatrixShape{8, 8, 8}, MatrixShape{8, 16, 16}, MatrixShape{16, 16, 16}})
          for (const CooperativeUse use : kUses) {
            const Caps caps = gpu({matrix}, invocations, bytes, subgroup);
            ASSERT_TRUE(can_cooperative(use, caps)) << subgroup << " lanes, " << bytes << " bytes";
            for (const ConvShape& s : shapes) {
              const CooperativeTile tile = choose_cooperative_tile(
                  {.rows = s.n * s.ho * s.wo, .columns = s.co, .summed = s.ci, .repeats = 1}, use, caps);
              EXPECT_EQ(tile.matrix, matrix);
              EXPECT_LE(tile.subgroups() * subgroup, invocations);
              EXPECT_LE(tile.shared_bytes(use), bytes);
              if (use == CooperativeUse::kWeightGradient) {
                EXPECT_EQ(tile.subgroups() * subgroup % tile.slab(), 0U);
              }
            }
          }
}

TEST(CooperativeTile, GrowsWithTheWorkAndTakesTheMatrixOfLeastPadding) {
  const Caps caps = gpu(kUsual);
  const auto choose = [&](int64_t rows, int64_t columns, int64_t summed) {
    return choose_cooperative_tile({rows, columns, summed, 1}, CooperativeUse::kProduct, caps);
  };
  const auto area = [](const CooperativeTile& t) { return t.tile_rows() * t.tile_columns(); };
  EXPECT_GT(area(choose(327680, 256, 256)), area(choose(256, 64, 256)));
  EXPECT_EQ(choose(327680, 8, 64).tile_columns(), 8U);
  EXPECT_EQ(choose(327680, 64, 8).slab(), 8U);
  EXPECT_EQ(choose(327680, 64, 64).slab(), 32U);
}

TEST(CooperativeTile, ADeviceTooSmallForAMatrixHasNone) {
  for (const CooperativeUse use : kUses) {
    const Caps small = gpu(kUsual, 1024, 512);
    EXPECT_FALSE(can_cooperative(use, small));
    EXPECT_FALSE(can_cooperative(use, gpu({})));
    test::expect_error([&] { choose_cooperative_tile({1, 1, 1, 1}, use, small); }, {"made up"});
  }
  EXPECT_FALSE(can_run_conv_kernel("cooperative", gpu({})));
  EXPECT_TRUE(can_run_conv_kernel("cooperative", gpu(kUsual)));
  EXPECT_TRUE(is_conv_kernel("cooperative"));
  EXPECT_FALSE(can_weight_gradient(kShape, gpu({}), WeightGradientKernel::kCooperative));
  EXPECT_TRUE(can_weight_gradient(kShape, gpu(kUsual), WeightGradientKernel::kCooperative));
}

TEST(CooperativeTile, WhatTheKernelCannotDoIsRefused) {
  const Caps caps = gpu(kUsual);
  const std::string key = tuning_key(kCooperativeForward, kShape);
  const CooperativeTile good{{16, 16, 16}, 2, 2, 2, 2, 2};
  EXPECT_TRUE(is_tuned_choice(key, numbers_of(good), caps));
  EXPECT_FALSE(is_tuned_choice(key, numbers_of(good), gpu({{8, 8, 8}})));
  EXPECT_FALSE(is_tuned_choice(key, {16, 16, 16, 2, 2, 2, 2}, caps));
  for (size_t i = 0; i < 8; ++i)
    for (const uint32_t value : {0U, 3U, 64U, 0x80000000U, 0xFFFFFFFFU}) {
      auto bad = numbers_of(good);
      bad[i] = value;
      EXPECT_FALSE(is_tuned_choice(key, bad, caps)) << i << ": " << value;
    }
  for (const CooperativeUse use : kUses)
    for (const CooperativeTile& tile : cooperative_tiles(use, caps)) EXPECT_TRUE(fits(tile, use, caps));
  // A slab of more pixels than the workgroup has invocations.
  const CooperativeTile deep{{16, 16, 16}, 1, 1, 1, 1, 4};
  EXPECT_TRUE(fits(deep, CooperativeUse::kProduct, caps));
  EXPECT_FALSE(is_tuned_choice(tuning_key(kCooperativeGradient, kShape), numbers_of(deep), caps));
}

TEST(KernelFamily, CooperativeMatricesAreForFloat16OnGpus) {
  for (const CooperativeUse use : kUses) {
    Caps caps = gpu(kUsual);
    EXPECT_TRUE(prefers_cooperative(kShape, use, true, caps));
    EXPECT_FALSE(prefers_cooperative(kShape, use, false, caps));
    EXPECT_FALSE(prefers_cooperative(kShape, use, true, gpu({})));
    ConvShape few = kShape;
    few.ci = 3;
    EXPECT_FALSE(prefers_cooperative(few, use, true, caps));
    caps.kernels = KernelFamily::kCooperative;
    EXPECT_TRUE(prefers_cooperative(few, use, true, caps));
    EXPECT_FALSE(prefers_cooperative(kShape, use, false, caps));
    caps.exact_sums = true;
    EXPECT_FALSE(prefers_cooperative(kShape, use, true, caps));
    for (const KernelFamily other : {KernelFamily::kShared, KernelFamily::kPlain}) {
      Caps held = gpu(kUsual);
      held.kernels = other;
      EXPECT_FALSE(prefers_cooperative(kShape, use, true, held));
    }
    Caps cpu = gpu(kUsual);
    cpu.type = DeviceType::kCpu;
    EXPECT_FALSE(prefers_cooperative(kShape, use, true, cpu));
    cpu.kernels = KernelFamily::kCooperative;
    EXPECT_TRUE(prefers_cooperative(kShape, use, true, cpu));
  }
}

TEST(KernelFamily, ADeviceWithoutCooperativeMatricesIsRefusedThemInALine) {
  const std::string why = missing_for(KernelFamily::kCooperative, gpu({}));
  EXPECT_NE(why.find("made up"), std::string::npos);
  EXPECT_NE(why.find("VK_KHR_cooperative_matrix"), std::string::npos);
  EXPECT_EQ(why.find('\n'), std::string::npos);
  EXPECT_TRUE(missing_for(KernelFamily::kCooperative, gpu(kUsual)).empty());
}

}  // namespace
}  // namespace vkopple
