#include "graph/matmul/linear_tile.h"

#include <algorithm>
#include <array>
#include <limits>

namespace vkopple {
namespace {

// An invocation keeps two sums of each of at most 32 products: 64 registers, and operands. The last fits
// wherever Vulkan's minimum limits hold.
constexpr std::array<LinearTile, 8> kTiles{{{1, 2, 16, 16, 8},
                                            {1, 2, 16, 8, 8},
                                            {1, 2, 8, 8, 16},
                                            {1, 1, 16, 8, 16},
                                            {1, 1, 16, 4, 16},
                                            {1, 1, 32, 2, 8},
                                            {1, 1, 64, 1, 4},
                                            {1, 1, 8, 8, 16}}};

/// Invocations below which a large GPU has multiprocessors without work, as for convolutions
/// (graph/conv/shared_tile.cpp). Not measured: no GPU was at hand.
constexpr double kFill = 32768;

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }

/// Cycles of one lane for a term of a tile: multiply-adds, vectors read from shared memory, which serves a
/// sixteenth of the lanes at a time, and single elements fetched from memory.
double step_cost(const LinearTile& t) {
  const double fetches = static_cast<double>(t.rows() + t.columns()) / t.invocations();
  return 16.0 * t.rows4 * t.columns4 + 4.0 * (t.rows4 + t.columns4) + 4.0 * fetches;
}

}  // namespace

bool fits(const LinearTile& tile, const Caps& caps) {
  return tile.invocations() <= caps.max_workgroup_size && tile.shared_bytes() <= caps.shared_memory_bytes;
}

std::span<const LinearTile> linear_tiles() { return kTiles; }

LinearTile choose_linear_tile(int64_t rows, int64_t columns, const Caps& caps) {
  LinearTile best = kTiles.back();
  double least = std::numeric_limits<double>::infinity();
  for (const LinearTile& tile : kTiles) {
    if (!fits(tile, caps)) continue;
    const auto groups = static_cast<double>(ceil_div(rows, tile.rows()) * ceil_div(columns, tile.columns()));
    const double now = std::max(groups * tile.invocations(), kFill) * step_cost(tile);
    if (now >= least) continue;
    best = tile;
    least = now;
  }
  return best;
}

}  // namespace vkopple
