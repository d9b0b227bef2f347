#include "graph/conv/conv_window.h"

#include <algorithm>
#include <limits>

#include "graph/conv/conv_push.h"
#include "graph/conv/conv_tile.h"
#include "graph/tensor.h"

namespace vkopple {
namespace {

/// As conv_window.comp has it.
struct WindowPush {
  int32_t n, in4, out4, h, w, out_h, out_w;
  int32_t kernel, stride, step, tap_step, phases;
  int32_t first[2], taps[2], base[2];
  int32_t tiles, bias, blocks;
};

int32_t i32(int64_t value) { return static_cast<int32_t>(value); }
uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }
int64_t ceil_divide(int64_t a, int64_t b) { return (a + b - 1) / b; }

/// The sizes of one product, whichever way round.
struct Sides {
  int64_t in, out, h, w, out_h, out_w, phases;
};

Sides sides_of(const ConvShape& s, ConvDirection direction) {
  if (direction == ConvDirection::kForward) return {s.ci, s.co, s.h, s.w, s.ho, s.wo, 1};
  return {s.co, s.ci, s.ho, s.wo, s.h, s.w, s.stride};
}

void set_row_taps(WindowPush& push, const ConvShape& s, ConvDirection direction) {
  const bool forward = direction == ConvDirection::kForward;
  push.phases = forward ? 1 : i32(s.stride);
  push.stride = forward ? i32(s.stride) : 1;
  push.step = forward ? 1 : -1;
  push.tap_step = push.phases;
  for (int64_t a = 0; a < push.phases; ++a) {
    // Transposed, tap ky reads row (a + padding − ky) / stride, where that is whole.
    const int64_t first = forward ? 0 : (a + s.padding) % s.stride;
    push.first[a] = i32(first);
    push.taps[a] = i32(first < s.kernel ? ceil_divide(s.kernel - first, push.phases) : 0);
    push.base[a] = i32(forward ? -s.padding : (a + s.padding - first) / s.stride);
  }
}

/// What a tile's parts take on one thread, in nanoseconds.
struct Costs {
  double fetch, product, far_product, sum, store, iteration, invocation;
};
/// Fitted to 19 shapes and 6 tiles each on lavapipe (Mesa 22.3.6, AMD Zen 5), within 40 % of every one: for
/// subgroups of 8 and of 16 lanes.
constexpr Costs kCosts8{4.1, 0.142, 0.219, 0.236, 41, 31, 64};
constexpr Costs kCosts16{14, 0.149, 0.194, 0.359, 74, 40, 199};
/// Products of an iteration from which on its code is too long for the processor's caches of instructions.
constexpr int64_t kNear = 1024;
constexpr int64_t kMostProducts = 2048;  ///< longer code takes seconds to compile

int64_t columns_of(const Sides& sides) { return ceil_divide(sides.out_w, sides.phases); }

int64_t products_of(const ConvShape& s, const Sides& sides, const ConvWindowTile& tile) {
  return tile.channels * s.kernel * std::min<int64_t>(sides.in, 4) * tile.pixels;
}

int64_t subgroups_of(const ConvShape& s, const Sides& sides, const ConvWindowTile& tile, int64_t lanes) {
  const int64_t stretches =
      s.n * ceil_divide(sides.out_h, sides.phases) * ceil_divide(columns_of(sides), tile.pixels);
  return ceil_divide(stretches, lanes) * ceil_divide(sides.out, tile.channels);
}

}  // namespace

bool can_conv_window(const Caps& caps) {
  return caps.cpu() && caps.subgroup_shuffle && (caps.subgroup_size == 8 || caps.subgroup_size == 16) &&
         !caps.exact_sums;
}

bool can_conv_window(const ConvShape& shape, const Caps& caps) {
  return can_conv_window(caps) && shape.kernel <= 3 && shape.dilation == 1 && shape.stride <= 2 &&
         shape.padding < shape.kernel;
}

bool prefers_conv_window(const ConvShape& shape, ConvDirection direction, const Caps& caps) {
  // Short rows leave most of a stretch empty. 1x1 kernels gain nothing but what wide subgroups bring.
  constexpr int64_t kFewestColumns = 8;
  return can_conv_window(shape, caps) && columns_of(sides_of(shape, direction)) >= kFewestColumns &&
         (shape.kernel > 1 || caps.subgroup_size == 16);
}

double conv_window_cost(const ConvShape& s, ConvDirection direction, const ConvWindowTile& tile,
                        const Caps& caps) {
  const Sides sides = sides_of(s, direction);
  const Costs& costs = caps.subgroup_size == 16 ? kCosts16 : kCosts8;
  const bool forward = direction == ConvDirection::kForward;
  const int64_t inputs =
      forward ? (tile.pixels - 1) * s.stride + s.kernel : tile.pixels + (s.kernel - 1) / s.stride;
  const int64_t weights = ceil_divide(ceil_divide(tile.channels, 8) * s.kernel, caps.subgroup_size / 8);
  const int64_t products = products_of(s, sides, tile);
  const int64_t vectors = ceil_divide(tile.channels, 4) * tile.pixels * sides.phases;
  const double iteration = costs.iteration + costs.fetch * static_cast<double>(inputs + weights) +
                           costs.product * static_cast<double>(products) +
                           costs.far_product * static_cast<double>(std::max<int64_t>(0, products - kNear)) +
                           costs.sum * static_cast<double>(4 * vectors);
  // Of one row phase, on average.
  const double iterations =
      static_cast<double>(s.kernel * blocks4(sides.in)) / static_cast<double>(sides.phases);
  const double subgroup =
      costs.invocation + costs.store * static_cast<double>(vectors) + iterations * iteration;
  return subgroup * static_cast<double>(sides.phases * subgroups_of(s, sides, tile, caps.subgroup_size));
}

ConvWindowTile choose_window_tile(const ConvShape& s, ConvDirection direction, const Caps& caps) {
  const Sides sides = sides_of(s, direction);
  ConvWindowTile best{};
  double least = std::numeric_limits<double>::infinity();
  for (const int64_t channels : {8, 16, 32})
    for (const int64_t positions : {8, 16}) {
      const ConvWindowTile tile{std::min(channels, sides.out <= 8 ? sides.out : channels),
                                positions / sides.phases};
      const bool smallest = channels == 8 && positions == 8;
      if (!smallest && (channels / 2 >= sides.out || products_of(s, sides, tile) > kMostProducts)) continue;
      const double cost = conv_window_cost(s, direction, tile, caps);
      if (cost >= least) continue;
      least = cost;
      best = tile;
    }
  return best;
}

void record_conv_window(Recorder& recorder, const ConvShape& s, ConvDirection direction,
                        const ConvOperands& operands, const Slice& packed, int64_t bias_at,
                        const ConvWindowTile& tile) {
  const Sides sides = sides_of(s, direction);
  const Caps& caps = recorder.caps();
  const int64_t columns = ceil_divide(sides.out_w, sides.phases);
  WindowPush push{.n = i32(s.n),
                  .in4 = i32(blocks4(sides.in)),
                  .out4 = i32(blocks4(sides.out)),
                  .h = i32(sides.h),
                  .w = i32(sides.w),
                  .out_h = i32(sides.out_h),
                  .out_w = i32(sides.out_w),
                  .kernel = i32(s.kernel),
                  .tiles = i32(ceil_divide(sides.out, tile.channels)),
                  .bias = i32(bias_at),
                  .blocks = i32(ceil_divide(columns, tile.pixels))};
  set_row_taps(push, s, direction);
  const bool forward = direction == ConvDirection::kForward;
  const bool whole =
      sides.out_w % (tile.pixels * sides.phases) == 0 && sides.w == columns * (forward ? s.stride : 1);
  const bool known =
      operands.accumulate == 0 && row_stores_pay(s.kernel * s.kernel * push.in4 / (sides.phases * sides.phases),
                                                 blocks4(tile.channels) * tile.pixels * sides.phases, caps);
  const int64_t rows = ceil_divide(sides.out_h, sides.phases);
  const int64_t count = ceil_divide(s.n * rows * push.blocks, caps.subgroup_size) * push.tiles;
  recorder.dispatch("conv_window",
                    {caps.subgroup_size, u32(tile.channels), u32(tile.pixels), operands.accumulate,
                     u32(s.kernel), u32(s.stride), u32(s.padding), forward ? 0U : 1U,
                     u32(std::min<int64_t>(sides.in, 4)), whole ? 1U : 0U, known ? 1U : 0U},
                    {operands.in, packed, operands.out}, push, phase_groups(count, sides.phases, caps));
}

}  // namespace vkopple
