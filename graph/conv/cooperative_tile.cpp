#include "graph/conv/cooperative_tile.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// Sums of an invocation: 64 leave a GPU's multiprocessor room for several workgroups. Not measured: no GPU was
/// at hand.
constexpr uint32_t kMostSums = 64;
/// Input channels of a slab: two matrices of the usual 16, so that barriers and addresses are for several
/// products.
constexpr uint32_t kSlabChannels = 32;
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

/// Time in cycles of one lane, as for tiles in shared memory, a slab of 8 input channels being the unit:
/// matrices multiply and add 8 times as fast as lanes do; shared memory serves as many bytes; a fetch of 8
/// channels costs some ten instructions.
double cost(const CooperativeTile& tile, const CooperativeWork& work, const Caps& caps) {
  const int64_t groups = work.phases * ceil_div(work.pixels, tile.tile_pixels()) *
                         ceil_div(work.out_channels, tile.tile_channels());
  const double slabs = static_cast<double>(ceil_div(work.in_channels, tile.slab_channels()));
  const double lanes = caps.subgroup_size;
  const double invocations = lanes * tile.subgroups();
  const double products = static_cast<double>(tile.tile_pixels()) * tile.tile_channels() / invocations;
  const double vectors = (tile.rows * tile.matrix.m + tile.columns * tile.matrix.n) / lanes;
  const double fetches = (tile.tile_pixels() + tile.tile_channels()) / invocations;
  const double step = products + 4 * vectors + 10 * fetches;
  return std::max(static_cast<double>(groups) * invocations, kFill) * slabs * tile.slab_channels() * step;
}

template <class F>
void each_tile(const Caps& caps, const F& f) {
  for (const MatrixShape& matrix : caps.cooperative_matrices)
    for (const auto& [rows, columns, down, across] : kTiles)
      for (uint32_t depth = std::max(1U, kSlabChannels / matrix.k); depth > 0; depth /= 2) {
        const CooperativeTile tile{matrix, rows, columns, down, across, depth};
        if (fits(tile, caps)) f(tile);
      }
}

}  // namespace

uint32_t CooperativeTile::shared_bytes() const {
  const uint32_t slab_row = (slab_channels() / 8 | 1) * 16;
  const uint32_t result_row = (matrix.n / 4 | 1) * 16;
  return 2 * (tile_pixels() + tile_channels()) * slab_row + subgroups() * matrix.m * result_row +
         4 * tile_pixels();
}

bool fits(const CooperativeTile& tile, const Caps& caps) {
  const uint32_t sums = tile.rows * tile.columns * tile.matrix.m * tile.matrix.n;
  return tile.subgroups() * caps.subgroup_size <= caps.max_workgroup_size &&
         tile.shared_bytes() <= caps.shared_memory_bytes && sums <= kMostSums * caps.subgroup_size;
}

bool has_cooperative_tile(const Caps& caps) {
  bool any = false;
  each_tile(caps, [&](const CooperativeTile&) { any = true; });
  return any;
}

CooperativeTile choose_cooperative_tile(const CooperativeWork& work, const Caps& caps) {
  std::optional<CooperativeTile> best;
  double least = std::numeric_limits<double>::infinity();
  each_tile(caps, [&](const CooperativeTile& tile) {
    const double now = cost(tile, work, caps);
    if (now >= least) return;
    best = tile;
    least = now;
  });
  if (!best)
    throw Error("no tile of cooperative matrices fits " + caps.name + "; leave the choice to the device");
  return *best;
}

}  // namespace vkopple
