#include <algorithm>
#include <array>
#include <limits>

#include "graph/conv/winograd.h"
#include "graph/conv/winograd_chunks.h"
#include "graph/op.h"

namespace vkopple {
namespace {

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }
uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }
int32_t i32(int64_t value) { return static_cast<int32_t>(value); }

/// What one lane of winograd_product makes.
struct ProductTile {
  int64_t out4, tiles;
};
constexpr std::array<ProductTile, 9> kTiles{
    {{8, 8}, {16, 4}, {16, 2}, {8, 4}, {8, 2}, {8, 1}, {4, 8}, {4, 4}, {2, 8}}};

/// Output channels that weights are transformed for: whole tiles of any size that could be chosen.
int64_t packed_channels(int64_t channels) {
  for (const int64_t most : {8, 16, 32})
    if (channels <= most) return most;
  return ceil_div(channels, 64) * 64;
}

/// Blocks of 8 output channels whose weights the lanes of a subgroup fetch at once.
int64_t shared_blocks(const ProductTile& tile, int64_t lanes) {
  return lanes >= 16 && tile.out4 % 4 == 0 ? 2 : 1;
}

/// Nanoseconds of a subgroup's work for one tile and frequency, from single costs measured on lavapipe (2 cores
/// of AMD Zen 5): for 8 lanes, 6 for a fetch and 17 for a vector stored; for any number of lanes 0.19 for a
/// multiply-add with its share of the shuffles and 0.25 for carrying a sum through the loop. The 7 for a vector
/// stored by rows are an estimate: an Intel with AVX-512 takes 13, where a fetch takes 8.5 and a multiply-add
/// 0.4.
double tile_cost(const ProductTile& tile, int64_t in4, int64_t lanes, bool row_stores) {
  const auto vectors = static_cast<double>(tile.out4 * tile.tiles);
  const auto eights = static_cast<double>(lanes) / 8;
  const double fetches = static_cast<double>(tile.out4 / (2 * shared_blocks(tile, lanes)) + tile.tiles);
  const double step = 6.0 * eights * fetches + (0.19 * 16 + 0.25 * 4) * vectors;
  return static_cast<double>(in4) * step + (row_stores ? 7 : 17) * eights * vectors + 100;
}

struct Plan {
  WinogradTile tile;
  int64_t in, out;       ///< channels
  int64_t in_h, in_w;    ///< of what is read
  int64_t out_h, out_w;  ///< of what is made
  int64_t offset;        ///< from an output's row to the first that it reads
  int64_t lanes;
  ProductTile product{};
  double product_cost = 0;  ///< nanoseconds of all subgroups
  WinogradChunks chunks{};

  int64_t weight_vectors() const { return packed_channels(out) * blocks4(in); }
  uint64_t weight_bytes() const { return static_cast<uint64_t>(chunks.frequencies() * weight_vectors()) * 16; }
  uint64_t scratch() const {
    return aligned(weight_bytes()) + aligned(chunks.bytes(blocks4(in))) + chunks.bytes(blocks4(out));
  }
};

void choose_product_tile(Plan& plan, int64_t all_tiles, int64_t frequencies, bool row_stores) {
  plan.product_cost = std::numeric_limits<double>::infinity();
  for (const ProductTile& tile : kTiles) {
    // For wide subgroups larger tiles gain nothing, and take the driver two seconds to compile.
    if (plan.lanes >= 16 && tile.out4 * tile.tiles > 32) continue;
    const int64_t groups =
        frequencies * ceil_div(blocks4(plan.out), tile.out4) * ceil_div(all_tiles, plan.lanes * tile.tiles);
    const double cost = tile_cost(tile, blocks4(plan.in), plan.lanes, row_stores) * static_cast<double>(groups);
    if (cost >= plan.product_cost) continue;
    plan.product_cost = cost;
    plan.product = tile;
  }
}

Plan make_plan(const ConvShape& s, ConvDirection direction, WinogradTile tile, const Caps& caps) {
  const bool forward = direction == ConvDirection::kForward;
  // The transposed product is the forward one of the flipped kernel.
  Plan plan{.tile = tile,
            .in = forward ? s.ci : s.co,
            .out = forward ? s.co : s.ci,
            .in_h = forward ? s.h : s.ho,
            .in_w = forward ? s.w : s.wo,
            .out_h = forward ? s.ho : s.h,
            .out_w = forward ? s.wo : s.w,
            .offset = forward ? -s.padding : s.padding - 2,
            .lanes = caps.subgroup_size};
  const auto m = static_cast<int64_t>(tile);
  choose_product_tile(plan, s.n * ceil_div(plan.out_h, m) * ceil_div(plan.out_w, m), (m + 2) * (m + 2),
                      caps.row_stores);
  plan.chunks = winograd_chunks(tile, s.n, plan.out_h, plan.out_w, plan.lanes * plan.product.tiles,
                                blocks4(plan.in) + blocks4(plan.out));
  return plan;
}

struct WeightPush {
  int32_t out_channels, in_channels, vectors;
};

struct ProductPush {
  int32_t in4, out4, out8, frequencies;
};

}  // namespace

uint64_t winograd_product_scratch(const ConvShape& shape, ConvDirection direction, WinogradTile tile,
                                  const Caps& caps) {
  return make_plan(shape, direction, tile, caps).scratch();
}

void record_winograd_product(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                             const ConvOperands& operands, Slice scratch, WinogradTile tile) {
  const Plan plan = make_plan(shape, direction, tile, recorder.caps());
  const WinogradChunks& chunks = plan.chunks;
  const int64_t in4 = blocks4(plan.in);
  const int64_t out4 = blocks4(plan.out);
  const Slice weights = scratch.sub(0, plan.weight_bytes());
  const uint64_t inputs_at = aligned(weights.bytes);
  const Slice inputs = scratch.sub(inputs_at, chunks.bytes(in4));
  const Slice products = scratch.sub(inputs_at + aligned(inputs.bytes), chunks.bytes(out4));

  const int64_t local = recorder.caps().row_stores ? plan.lanes : recorder.caps().flat_workgroup();
  recorder.dispatch(chunks.made == 4 ? "winograd_weights.f4" : "winograd_weights.f2",
                    {u32(local), direction == ConvDirection::kTransposed ? 1U : 0U,
                     plan.weight_vectors() % local == 0 ? 1U : 0U},
                    {operands.w, weights}, WeightPush{i32(plan.out), i32(plan.in), i32(plan.weight_vectors())},
                    {u32(ceil_div(plan.weight_vectors(), local)), 1, 1});
  const bool whole = plan.out_h % chunks.made == 0 && plan.out_w % chunks.made == 0;
  for (int64_t first = 0; first < chunks.blocks(); first += chunks.chunk_blocks) {
    const int64_t blocks = std::min(chunks.chunk_blocks, chunks.blocks() - first);
    record_winograd_transform(recorder, "winograd_input", chunks, first, blocks,
                              {plan.in, plan.in_h, plan.in_w, plan.offset}, {operands.in, inputs});
    recorder.dispatch(
        "winograd_product",
        {u32(plan.lanes), u32(plan.product.out4), u32(plan.product.tiles),
         u32(shared_blocks(plan.product, plan.lanes))},
        {inputs, weights, products},
        ProductPush{i32(in4), i32(out4), i32(packed_channels(plan.out) / 8), i32(chunks.frequencies())},
        {u32(ceil_div(out4, plan.product.out4)), u32(chunks.frequencies()), u32(blocks)});
    record_winograd_transform(recorder, "winograd_output", chunks, first, blocks,
                              {plan.out, plan.out_h, plan.out_w},
                              {products, operands.bias, operands.out, operands.out},
                              static_cast<bool>(operands.bias), {operands.accumulate, whole ? 1U : 0U});
  }
}

double winograd_product_cost(const ConvShape& shape, ConvDirection direction, WinogradTile tile,
                             const Caps& caps, int64_t threads) {
  const Plan plan = make_plan(shape, direction, tile, caps);
  const auto per_lane = [&](int64_t vectors, double cost) {
    return static_cast<double>(ceil_div(vectors, 8)) * cost;
  };
  const auto f = static_cast<double>(plan.chunks.frequencies());
  const auto made = static_cast<double>(plan.chunks.made * plan.chunks.made);
  // Measured where rows are stored on an Intel with AVX-512 (Mesa 22.3.6): the transforms wait for memory, more
  // than their instructions make expect. Elsewhere put together of single costs on a Zen 5.
  const double input = caps.row_stores ? 33 * f : 27 * f;
  const double output = caps.row_stores ? 28 * f + 30 * made : 9 * f + 20 * made;
  const double weights = per_lane(plan.weight_vectors(), 36 * 6 + 20 * f);
  const double transforms = per_lane(plan.chunks.blocks() * plan.chunks.width * blocks4(plan.in), input) +
                            per_lane(plan.chunks.blocks() * plan.chunks.width * blocks4(plan.out), output);
  const int64_t chunks = ceil_div(plan.chunks.blocks(), plan.chunks.chunk_blocks);
  return (weights + transforms + plan.product_cost) / static_cast<double>(threads) +
         15e3 * static_cast<double>(1 + 3 * chunks);
}

}  // namespace vkopple
