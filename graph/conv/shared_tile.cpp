#include "graph/conv/shared_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace vkopple {
namespace {

/// Sums of an invocation in vectors of 4: 64 numbers, with the operands some 130 registers, leave an NVIDIA or
/// AMD multiprocessor room for several workgroups. Not measured: no GPU was at hand.
constexpr uint32_t kMostSums = 16;
constexpr uint32_t kMostInvocations = 1024;
constexpr uint32_t kMostDepth = 32;

/// Invocations below which a large GPU has multiprocessors without work: about 128 of them with 256 each.
constexpr double kFill = 32768;

// Without depth, which is 1 where the input has few channels.
constexpr std::array<SharedTile, 17> kTiles{{{2, 8, 16, 16, 2},
                                             {2, 8, 16, 8, 2},
                                             {2, 8, 8, 8, 2},
                                             {2, 4, 16, 8, 2},
                                             {2, 4, 32, 4, 2},
                                             {2, 8, 16, 4, 2},
                                             {2, 4, 16, 4, 2},
                                             {2, 2, 16, 4, 2},
                                             {1, 2, 16, 8, 2},
                                             {1, 2, 8, 8, 2},
                                             {2, 4, 32, 2, 2},
                                             {2, 2, 32, 2, 2},
                                             {1, 2, 16, 4, 2},
                                             {2, 4, 64, 1, 1},
                                             {2, 2, 64, 1, 2},
                                             {1, 4, 64, 1, 1},
                                             {1, 2, 64, 1, 2}}};

constexpr std::array<SharedGradientTile, 9> kGradientTiles{{{2, 2, 16, 16, 8},
                                                            {2, 2, 16, 8, 8},
                                                            {2, 2, 8, 8, 8},
                                                            {1, 2, 8, 8, 8},
                                                            {1, 2, 16, 4, 8},
                                                            {1, 2, 16, 2, 8},
                                                            {1, 1, 16, 4, 8},
                                                            {1, 1, 8, 8, 8},
                                                            {1, 2, 32, 1, 4}}};

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }

bool powers_of_2(std::initializer_list<uint32_t> values) {
  return std::all_of(values.begin(), values.end(), [](uint32_t v) { return std::has_single_bit(v); });
}

template <class Tile>
bool fits_limits(const Tile& tile, const Caps& caps) {
  return is_shared_tile(tile) && tile.invocations() <= caps.max_workgroup_size &&
         tile.shared_bytes() <= caps.shared_memory_bytes;
}

/// Time of `groups` workgroups, in cycles of one lane: on NVIDIA's multiprocessors 128 lanes multiply and add
/// while shared memory serves 8 vectors, one if all lanes of a subgroup read the same; a fetch from memory
/// costs some ten instructions. Too few invocations cost as much as kFill.
double cost(int64_t groups, uint32_t invocations, double products, double vectors, double fetches) {
  const double step = products + 4 * vectors + 10 * fetches / invocations;
  return std::max(static_cast<double>(groups) * invocations, kFill) * step;
}

}  // namespace

bool is_shared_tile(const SharedTile& t) {
  return powers_of_2({t.out4, t.pixels, t.across, t.down, t.depth}) && t.depth <= kMostDepth &&
         t.across <= kMostInvocations && t.down <= kMostInvocations && t.invocations() <= kMostInvocations &&
         t.out4 <= kMostSums && t.pixels <= kMostSums && t.out4 * t.pixels <= kMostSums;
}

bool is_shared_tile(const SharedGradientTile& t) {
  return powers_of_2({t.rows4, t.columns4, t.across, t.down, t.depth}) && t.depth <= kMostDepth &&
         t.across <= kMostInvocations && t.down <= kMostInvocations && t.invocations() <= kMostInvocations &&
         t.depth <= t.invocations() && t.rows4 <= kMostSums && t.columns4 <= kMostSums &&
         4 * t.rows4 * t.columns4 <= kMostSums;
}

bool fits(const SharedTile& tile, const Caps& caps) { return fits_limits(tile, caps); }
bool fits(const SharedGradientTile& tile, const Caps& caps) { return fits_limits(tile, caps); }

std::span<const SharedTile> shared_tiles() { return kTiles; }
std::span<const SharedGradientTile> shared_gradient_tiles() { return kGradientTiles; }

SharedTile choose_shared_tile(const SharedWork& work, const Caps& caps) {
  SharedTile best = kTiles.back();
  double least = std::numeric_limits<double>::infinity();
  for (SharedTile tile : kTiles) {
    // A slab lies within one tap: vectors that the last of a tap has too many are multiplied for nothing.
    if (work.in4 % 2 != 0 && work.in4 < 8) tile.depth = 1;
    if (!fits(tile, caps)) continue;
    const int64_t groups =
        work.phases * ceil_div(work.pixels, tile.tile_pixels()) * ceil_div(4 * work.out4, tile.tile_channels());
    const double now = cost(groups, tile.invocations(), 16.0 * tile.out4 * tile.pixels, tile.pixels + tile.out4,
                            tile.tile_pixels() + tile.tile_channels());
    if (now >= least) continue;
    best = tile;
    least = now;
  }
  return best;
}

SharedGradientTile choose_shared_gradient_tile(const SharedGradientWork& work, const Caps& caps) {
  SharedGradientTile best = kGradientTiles.back();
  double least = std::numeric_limits<double>::infinity();
  for (const SharedGradientTile& tile : kGradientTiles) {
    if (!fits(tile, caps)) continue;
    // The sum is cut into strips until there are groups enough, so that tiles alone need not fill the device.
    const double work_of_tile = static_cast<double>(ceil_div(work.rows4, tile.tile_rows4()) *
                                                    ceil_div(work.columns4, tile.tile_columns4()));
    const double step = 16.0 * tile.rows4 * tile.columns4 + 4.0 * (tile.rows4 + tile.columns4) +
                        10.0 * (tile.tile_rows4() + tile.tile_columns4()) / tile.invocations();
    const double now = work_of_tile * tile.invocations() * step;
    if (now >= least) continue;
    best = tile;
    least = now;
  }
  return best;
}

}  // namespace vkopple
