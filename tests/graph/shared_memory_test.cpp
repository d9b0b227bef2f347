#include <gtest/gtest.h>

#include "graph/conv/cooperative_tile.h"
#include "graph/conv/shared_tile.h"
#include "graph/matmul/linear_tile.h"
#include "tests/support/gpu_caps.h"
#include "tests/support/shader_needs.h"

namespace vkopple {
namespace {

/// That what the host says of a tile's shared memory is what the shader declares.
void expect_shared(std::string_view shader, const std::vector<uint32_t>& constants, uint64_t bytes) {
  std::map<uint32_t, uint32_t> ids;
  for (uint32_t i = 0; i < constants.size(); ++i) ids[i] = constants[i];
  for (const AccessPath access : {AccessPath::kStorage, AccessPath::kTexel})
    EXPECT_EQ(test::shader_needs(find_shader(shader, access), ids).shared_bytes, bytes)
        << shader << " of " << testing::PrintToString(constants);
}

TEST(SharedMemory, OfConvolutionsIsWhatTheHostSays) {
  for (const SharedTile& t : shared_tiles())
    expect_shared("conv_shared", {t.invocations(), t.out4, t.pixels, t.across, t.down, t.depth},
                  t.shared_bytes());
  for (const SharedGradientTile& t : shared_gradient_tiles())
    expect_shared("weight_gradient_shared", {t.invocations(), t.rows4, t.columns4, t.across, t.down, t.depth},
                  t.shared_bytes());
}

TEST(SharedMemory, OfProductsOfMatricesIsWhatTheHostSays) {
  for (const LinearTile& t : linear_tiles())
    expect_shared("linear_shared", {t.invocations(), t.rows4, t.columns4, t.across, t.down, t.depth},
                  t.shared_bytes());
}

TEST(SharedMemory, OfCooperativeMatricesIsWhatTheHostSays) {
  Caps caps = test::gpu_caps(1024, 65536, 32);
  caps.cooperative_matrices = {{16, 16, 16}, {16, 8, 16}, {16, 8, 8}, {8, 8, 8}};
  const auto constants = [&](const CooperativeTile& t) {
    return std::vector<uint32_t>{t.subgroups() * caps.subgroup_size,
                                 t.matrix.m,
                                 t.matrix.n,
                                 t.matrix.k,
                                 t.rows,
                                 t.columns,
                                 t.down,
                                 t.across,
                                 t.depth};
  };
  for (const CooperativeTile& t : cooperative_tiles(CooperativeUse::kProduct, caps))
    expect_shared("conv_cooperative", constants(t), t.shared_bytes(CooperativeUse::kProduct));
  for (const CooperativeTile& t : cooperative_tiles(CooperativeUse::kWeightGradient, caps))
    expect_shared("weight_gradient_cooperative", constants(t), t.shared_bytes(CooperativeUse::kWeightGradient));
}

}  // namespace
}  // namespace vkopple
