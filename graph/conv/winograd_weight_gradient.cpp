#include <algorithm>
#include <limits>

#include "graph/conv/winograd.h"
#include "graph/conv/winograd_chunks.h"
#include "graph/op.h"

namespace vkopple {
namespace {

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }
uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }
int32_t i32(int64_t value) { return static_cast<int32_t>(value); }

/// Tiles that winograd_weight_product takes in one round of its loop.
constexpr int64_t kRound = 8;
constexpr int64_t kBlockWidth = 64;
/// Tiles that a lane adds one by one before the sum of all takes them: keeps the rounding of long sums small.
constexpr int64_t kLongestSum = 512;

struct Plan {
  int64_t in4, out4;
  int64_t lanes;
  int64_t lane_in4, lane_out4;  ///< vectors of channels that a lane sums
  double product_cost;          ///< nanoseconds of all subgroups
  WinogradChunks chunks;

  uint64_t product_bytes() const { return static_cast<uint64_t>(chunks.frequencies() * 4 * out4 * in4) * 16; }
  uint64_t scratch() const {
    return aligned(product_bytes()) + aligned(chunks.bytes(in4)) + chunks.bytes(out4);
  }
};

/// Vectors of output channels that the lanes of a subgroup fetch at once.
int64_t shared_vectors(int64_t lanes) { return lanes >= 16 ? 2 : 1; }

/// Nanoseconds of a subgroup for a round of the loop, from the same costs as those of winograd_product.
double round_cost(int64_t lane_in4, int64_t lane_out4, int64_t lanes) {
  const auto sums = static_cast<double>(16 * lane_in4 * lane_out4);
  const double fetch = 6.0 / 8 * static_cast<double>(lanes);
  return fetch * static_cast<double>(kRound * lane_in4 + lane_out4 / shared_vectors(lanes)) +
         (0.19 * kRound + 0.25) * sums;
}

Plan make_plan(const ConvShape& s, WinogradTile tile, const Caps& caps) {
  const auto m = static_cast<int64_t>(tile);
  const int64_t tiles = s.n * ceil_div(s.ho, m) * ceil_div(s.wo, m);
  Plan plan{.in4 = blocks4(s.ci),
            .out4 = blocks4(s.co),
            .lanes = caps.subgroup_size,
            .lane_in4 = 1,
            .lane_out4 = 8,
            .product_cost = std::numeric_limits<double>::infinity(),
            .chunks = {}};
  const int64_t step = std::max<int64_t>(kRound, caps.subgroup_size);  // transforms take a subgroup's tiles
  const int64_t width = std::min(kBlockWidth, ceil_div(tiles, step) * step);
  plan.chunks = winograd_chunks(tile, s.n, s.ho, s.wo, width, plan.in4 + plan.out4, kLongestSum);
  const int64_t rounds = ceil_div(tiles, kRound);
  for (const int64_t lane_out4 : {8, 4})
    for (const int64_t lane_in4 : {2, 1}) {
      const int64_t groups = plan.chunks.frequencies() * ceil_div(plan.in4, plan.lanes * lane_in4) *
                             ceil_div(plan.out4, lane_out4);
      const double cost = static_cast<double>(groups) *
                          (static_cast<double>(rounds) * round_cost(lane_in4, lane_out4, plan.lanes) +
                           70 * static_cast<double>(lane_in4 * lane_out4));
      if (cost >= plan.product_cost) continue;
      plan.product_cost = cost;
      plan.lane_in4 = lane_in4;
      plan.lane_out4 = lane_out4;
    }
  return plan;
}

struct ProductPush {
  int32_t in4, out4, blocks, width, frequencies;
};

struct GradientPush {
  int32_t co, ci, in4, vectors;
  uint32_t accumulate;
};

}  // namespace

uint64_t winograd_weight_gradient_scratch(const ConvShape& shape, WinogradTile tile, const Caps& caps) {
  return make_plan(shape, tile, caps).scratch();
}

void record_winograd_weight_gradient(Recorder& recorder, const ConvShape& s, const Slice& x, const Slice& dy,
                                     const Slice& dw, uint32_t accumulate, const Slice& scratch,
                                     WinogradTile tile) {
  const Plan plan = make_plan(s, tile, recorder.caps());
  const WinogradChunks& chunks = plan.chunks;
  const Slice product = scratch.sub(0, plan.product_bytes());
  const Slice inputs = scratch.sub(aligned(product.bytes), chunks.bytes(plan.in4));
  const Slice gradients = scratch.sub(aligned(product.bytes) + aligned(inputs.bytes), chunks.bytes(plan.out4));

  const bool rows = recorder.caps().row_stores && plan.in4 % plan.lanes == 0;
  for (int64_t first = 0; first < chunks.blocks(); first += chunks.chunk_blocks) {
    const int64_t blocks = std::min(chunks.chunk_blocks, chunks.blocks() - first);
    record_winograd_transform(recorder, "winograd_input", chunks, first, blocks, {s.ci, s.h, s.w, -s.padding},
                              {x, inputs});
    record_winograd_transform(recorder, "winograd_gradient", chunks, first, blocks, {s.co, s.ho, s.wo},
                              {dy, gradients});
    recorder.dispatch(
        "winograd_weight_product",
        {u32(plan.lanes), u32(plan.lane_out4), u32(plan.lane_in4), first > 0 ? 1U : 0U,
         u32(shared_vectors(plan.lanes)), rows ? 1U : 0U},
        {inputs, gradients, product, product},
        ProductPush{i32(plan.in4), i32(plan.out4), i32(blocks), i32(chunks.width), i32(chunks.frequencies())},
        {u32(ceil_div(plan.out4, plan.lane_out4)), u32(ceil_div(plan.in4, plan.lanes * plan.lane_in4)),
         u32(chunks.frequencies())});
  }
  const auto vectors = 4 * plan.out4 * plan.in4;
  recorder.dispatch_flat(chunks.made == 4 ? "winograd_weight_gradient.f4" : "winograd_weight_gradient.f2",
                         static_cast<uint64_t>(s.co * plan.in4), {product, dw, dw},
                         GradientPush{i32(s.co), i32(s.ci), i32(plan.in4), i32(vectors), accumulate},
                         {s.ci % 4 == 0 ? 1U : 0U});
}

double winograd_weight_gradient_cost(const ConvShape& s, WinogradTile tile, const Caps& caps, int64_t threads) {
  const Plan plan = make_plan(s, tile, caps);
  const auto f = static_cast<double>(plan.chunks.frequencies());
  const auto groups = [&](int64_t vectors) { return static_cast<double>(ceil_div(vectors, 8)); };
  const double store = caps.row_stores ? 7 : 17;  // as in winograd_product
  const int64_t tiles = plan.chunks.blocks() * plan.chunks.width;
  const double transforms =
      groups(tiles * plan.in4) * (10 + store) * f + groups(tiles * plan.out4) * (6 + store) * f;
  const double weights = groups(s.co * plan.in4) * (9 * f + 9 * 20);
  const int64_t chunks = ceil_div(plan.chunks.blocks(), plan.chunks.chunk_blocks);
  return (weights + transforms + plan.product_cost) / static_cast<double>(threads) +
         15e3 * static_cast<double>(1 + 3 * chunks);
}

}  // namespace vkopple
