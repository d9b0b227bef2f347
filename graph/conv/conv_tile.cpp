#include "graph/conv/conv_tile.h"

#include <array>
#include <limits>

namespace vkopple {
namespace {

constexpr std::array<ConvTile, 11> kTiles{
    {{8, 8}, {8, 4}, {8, 2}, {8, 1}, {4, 8}, {4, 4}, {2, 8}, {2, 4}, {2, 2}, {1, 8}, {1, 2}}};

int64_t ceil_divide(int64_t a, int64_t b) { return (a + b - 1) / b; }

/// Nanoseconds that a lane group takes for 4 input channels of one tap, as measured on lavapipe: 6 a fetch,
/// 0.19 a multiply-add with its share of the shuffles, 0.25 for every sum's masked update.
double step_cost(const ConvTile& tile) {
  const double sums = 4.0 * tile.out4 * tile.pixels;
  const double fetches = (tile.out4 + 1) / 2 + tile.pixels;
  return 6 * fetches + (4 * 0.19 + 0.25) * sums;
}

}  // namespace

ConvTile choose_shuffle_tile(int64_t pixels, int64_t out_channels, int64_t lanes) {
  ConvTile best = kTiles.back();
  double best_cost = std::numeric_limits<double>::infinity();
  for (const ConvTile& tile : kTiles) {
    if (tile.out4 == 1 && out_channels > 4) continue;
    const int64_t groups = ceil_divide(out_channels, 4 * tile.out4) * ceil_divide(pixels, lanes * tile.pixels);
    const double cost = step_cost(tile) * static_cast<double>(groups);
    if (cost < best_cost) {
      best = tile;
      best_cost = cost;
    }
  }
  return best;
}

ConvTile choose_uniform_tile(int64_t pixels, int64_t out_channels, int64_t lanes) {
  // Enough workgroups to fill a device before tiles grow.
  constexpr int64_t kEnough = 256;
  const int out4 = out_channels <= 4 ? 1 : 2;
  for (const int many : {4, 2})
    if (ceil_divide(pixels, lanes * many) * ceil_divide(out_channels, 4 * out4) >= kEnough) return {out4, many};
  return {out4, 1};
}

}  // namespace vkopple
