#include "graph/conv/weight_gradient_partial.h"

namespace vkopple {
namespace {

/// Strips that a tile is chosen for: enough that the device is full whatever the tile.
constexpr int64_t kManyStrips = 512;

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }

}  // namespace

CooperativePlan plan_cooperative(const ConvShape& s, const Caps& caps, ConvStorage storage) {
  const CooperativeWork work{.rows = s.co,
                             .columns = s.kernel * s.kernel * 4 * blocks4(s.ci),
                             .summed = s.n * s.ho * s.wo,
                             .repeats = kManyStrips};
  const CooperativeUse use = CooperativeUse::kWeightGradient;
  const auto tuned = tuned_cooperative_tile(tuning_key(kCooperativeGradient, s, storage), use, caps);
  CooperativePlan plan{
      .tile = tuned ? *tuned : choose_cooperative_tile(work, use, caps), .strip_pixels = 0, .partial = {}};
  plan.row_groups = ceil_div(work.rows, plan.tile.tile_rows());
  plan.column_groups = ceil_div(work.columns, plan.tile.tile_columns());
  plan.strip_pixels = strip_of(work.summed, plan.row_groups * plan.column_groups, plan.tile.slab());
  plan.partial.strips = ceil_div(work.summed, plan.strip_pixels);
  plan.partial.many_lanes = true;
  return plan;
}

void record_cooperative(Recorder& recorder, const ConvShape& s, const CooperativePlan& plan, const Slice& x,
                        const Slice& dy, const Slice& partial) {
  const CooperativeTile& tile = plan.tile;
  recorder.dispatch("weight_gradient_cooperative",
                    {tile.subgroups() * recorder.caps().subgroup_size, tile.matrix.m, tile.matrix.n,
                     tile.matrix.k, tile.rows, tile.columns, tile.down, tile.across, tile.depth},
                    {x, dy, partial}, StripPush(s, plan.strip_pixels, tile.slab()),
                    {static_cast<uint32_t>(plan.column_groups), static_cast<uint32_t>(plan.row_groups),
                     static_cast<uint32_t>(plan.partial.strips)});
}

}  // namespace vkopple
