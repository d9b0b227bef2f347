#include "graph/conv/conv_tile.h"

#include <array>
#include <limits>

namespace vkopple {
namespace {

constexpr std::array<ConvTile, 11> kTiles{
    {{8, 8}, {8, 4}, {8, 2}, {8, 1}, {4, 8}, {4, 4}, {2, 8}, {2, 4}, {2, 2}, {1, 8}, {1, 2}}};

int64_t ceil_divide(int64_t a, int64_t b) { return (a + b - 1) / b; }

/// Nanoseconds that a subgroup of 8 lanes takes, fitted to measurements on lavapipe (2 cores of AMD Zen 5): 6
/// for a fetch, 0.67 for 4 multiply-adds with their share of the shuffles, 0.5 for carrying a sum from tap to
/// tap, 38 for a vector stored.
double tile_cost(const ConvTile& tile, const ConvWork& work) {
  const auto vectors = static_cast<double>(tile.out4 * tile.pixels);
  const auto fetches = static_cast<double>((tile.out4 + 1) / 2 + tile.pixels);
  const double step = 6 * fetches + 0.67 * 4 * vectors;
  const double tap =
      static_cast<double>(work.in4) * step + 0.5 * 4 * vectors + 4 * static_cast<double>(tile.pixels);
  return work.taps * tap + 38 * vectors;
}

int64_t workgroups(const ConvTile& tile, const ConvWork& work) {
  return ceil_divide(work.out_channels, 4 * tile.out4) * ceil_divide(work.pixels, work.lanes * tile.pixels);
}

}  // namespace

std::span<const ConvTile> conv_tiles() { return kTiles; }

ConvTile choose_shuffle_tile(const ConvWork& work, int64_t threads) {
  ConvTile best = kTiles.back();
  double best_cost = std::numeric_limits<double>::infinity();
  for (const ConvTile& tile : kTiles) {
    if (tile.out4 == 1 && work.out_channels > 4) continue;
    const int64_t rounds = ceil_divide(workgroups(tile, work), threads);
    const double cost = tile_cost(tile, work) * static_cast<double>(rounds);
    if (cost < best_cost) {
      best = tile;
      best_cost = cost;
    }
  }
  return best;
}

ConvTile choose_uniform_tile(const ConvWork& work) {
  // Tiles grow once there are workgroups enough to fill a device.
  constexpr int64_t kEnough = 256;
  const int64_t out4 = work.out_channels <= 4 ? 1 : 2;
  for (const int64_t pixels : {4, 2})
    if (const ConvTile tile{out4, pixels}; workgroups(tile, work) >= kEnough) return tile;
  return {out4, 1};
}

bool row_stores_pay(int64_t iterations, int64_t vectors, const Caps& caps) {
  // With 3x3 kernels: up to 16 input channels, or 128 where the work is long.
  const int64_t short_sum = caps.long_work ? 288 : 36;
  // Of a subgroup; 1024 take 0.7 s to compile.
  const int64_t most_vectors = caps.long_work ? 1024 : 256;
  return caps.row_stores && iterations <= short_sum && vectors * caps.subgroup_size <= most_vectors;
}

}  // namespace vkopple
