#include "graph/conv/cooperative_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// Sums of an invocation: 64 leave a GPU's multiprocessor room for several workgroups. Not measured: no GPU was
/// at hand.
constexpr uint32_t kMostSums = 64;
/// Matrices or subgroups in a row.
constexpr uint32_t kMostMatrices = 32;
/// Below, most of a matrix of 16 would be padding, and the shared family is as fast by estimate.
constexpr int64_t kFewestChannels = 8;
/// Summands of a slab: two matrices of the usual 16, so that barriers and addresses are for several products.
constexpr uint32_t kSlab = 32;
/// Invocations below which a large GPU has multiprocessors without work, as for tiles in shared memory.
constexpr double kFill = 32768;

// Rows, columns, down, across.
constexpr std::array<std::array<uint32_t, 4>, 11> kTiles{{{4, 2, 2, 2},
                                                          {2, 4, 2, 2},
                                                          {2, 2, 4, 2},
                                                          {2, 2, 2, 2},
                                                          {2, 2, 4, 1},
                                                          {2, 1, 4, 1},
                                                          {1, 2, 2, 2},
                                                          {2, 2, 1, 1},
                                                          {1, 1, 2, 2},
                                                          {1, 2, 1, 1},
                                                          {1, 1, 1, 1}}};

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }

/// Time in cycles of one lane, as for tiles in shared memory, a slab of 8 summands being the unit: matrices
/// multiply and add 8 times as fast as lanes do; shared memory serves as many bytes; a fetch of 8 numbers costs
/// some ten instructions.
double cost(const CooperativeTile& tile, const CooperativeWork& work, const Caps& caps) {
  const int64_t groups =
      work.repeats * ceil_div(work.rows, tile.tile_rows()) * ceil_div(work.columns, tile.tile_columns());
  const double slabs = static_cast<double>(ceil_div(work.summed, tile.slab()));
  const double lanes = caps.subgroup_size;
  const double invocations = lanes * tile.subgroups();
  const double products = static_cast<double>(tile.tile_rows()) * tile.tile_columns() / invocations;
  const double vectors = (tile.rows * tile.matrix.m + tile.columns * tile.matrix.n) / lanes;
  const double fetches = (tile.tile_rows() + tile.tile_columns()) / invocations;
  const double step = products + 4 * vectors + 10 * fetches;
  return std::max(static_cast<double>(groups) * invocations, kFill) * slabs * tile.slab() * step;
}

/// Bytes of a row of `numbers` of float16 or float32 in shared memory: an odd number of vectors of 16.
uint32_t row_bytes(uint32_t numbers, uint32_t number_bytes) { return (numbers * number_bytes / 16 | 1) * 16; }

}  // namespace

uint32_t CooperativeTile::shared_bytes(CooperativeUse use) const {
  const uint32_t results = subgroups() * matrix.m * row_bytes(matrix.n, 4);
  if (use == CooperativeUse::kWeightGradient)
    return 2 * slab() * (row_bytes(tile_rows(), 2) + row_bytes(tile_columns(), 2)) + results;
  return 2 * (tile_rows() + tile_columns()) * row_bytes(slab(), 2) + results + 4 * tile_rows();
}

bool fits(const CooperativeTile& tile, CooperativeUse use, const Caps& caps) {
  const auto& matrices = caps.cooperative_matrices;
  if (std::find(matrices.begin(), matrices.end(), tile.matrix) == matrices.end()) return false;
  // Small enough that nothing below overflows.
  for (const uint32_t count : {tile.rows, tile.columns, tile.down, tile.across, tile.depth})
    if (!std::has_single_bit(count) || count > kMostMatrices) return false;
  const uint32_t invocations = tile.subgroups() * caps.subgroup_size;
  const uint32_t sums = tile.rows * tile.columns * tile.matrix.m * tile.matrix.n;
  // An invocation of the weight gradient fetches one pixel of a slab.
  const bool fetches = use == CooperativeUse::kProduct || tile.slab() <= invocations;
  return fetches && invocations <= caps.max_workgroup_size &&
         tile.shared_bytes(use) <= caps.shared_memory_bytes && sums <= kMostSums * caps.subgroup_size;
}

std::vector<CooperativeTile> cooperative_tiles(CooperativeUse use, const Caps& caps) {
  std::vector<CooperativeTile> all;
  for (const MatrixShape& matrix : caps.cooperative_matrices)
    for (const auto& [rows, columns, down, across] : kTiles)
      for (uint32_t depth = std::max(1U, kSlab / matrix.k); depth > 0; depth /= 2) {
        const CooperativeTile tile{matrix, rows, columns, down, across, depth};
        if (fits(tile, use, caps)) all.push_back(tile);
      }
  return all;
}

bool can_cooperative(CooperativeUse use, const Caps& caps) { return !cooperative_tiles(use, caps).empty(); }

bool prefers_cooperative(const ConvShape& shape, CooperativeUse use, bool float16, const Caps& caps) {
  if (!float16 || caps.exact_sums || !can_cooperative(use, caps)) return false;
  if (caps.kernels == KernelFamily::kCooperative) return true;
  return caps.kernels == KernelFamily::kAuto && !caps.cpu() && std::min(shape.ci, shape.co) >= kFewestChannels;
}

CooperativeTile choose_cooperative_tile(const CooperativeWork& work, CooperativeUse use, const Caps& caps) {
  std::optional<CooperativeTile> best;
  double least = std::numeric_limits<double>::infinity();
  for (const CooperativeTile& tile : cooperative_tiles(use, caps)) {
    const double now = cost(tile, work, caps);
    if (now >= least) continue;
    best = tile;
    least = now;
  }
  if (!best)
    throw Error("no tile of cooperative matrices fits " + caps.name + "; leave the choice to the device");
  return *best;
}

}  // namespace vkopple
