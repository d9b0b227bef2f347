#include <algorithm>

#include "graph/conv/weight_gradient_partial.h"

namespace vkopple {
namespace {

constexpr int64_t kLongestSum = 2048;   ///< pixels that one invocation adds one by one, for accuracy
constexpr int64_t kFewestSlabs = 8;     ///< below, starting a workgroup and the second stage cost too much
constexpr int64_t kWantedGroups = 512;  ///< to fill a large GPU with some to spare
constexpr int64_t kMostStrips = 65535;  ///< of any device's third direction

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }
int32_t i32(int64_t value) { return static_cast<int32_t>(value); }

SharedGradientWork work_of(const ConvShape& s) {
  return {.pixels = s.n * s.ho * s.wo, .rows4 = blocks4(s.co), .columns4 = s.kernel * s.kernel * blocks4(s.ci)};
}

}  // namespace

int64_t strip_of(int64_t pixels, int64_t groups, int64_t slab) {
  const int64_t wanted = std::min(ceil_div(kWantedGroups, groups), pixels / (kFewestSlabs * slab));
  const int64_t strips = std::clamp(std::max(wanted, ceil_div(pixels, kLongestSum)), int64_t{1}, kMostStrips);
  return ceil_div(ceil_div(pixels, strips), slab) * slab;
}

StripPush::StripPush(const ConvShape& s, int64_t pixels, int64_t slab)
    : n(i32(s.n)),
      ci4(i32(blocks4(s.ci))),
      h(i32(s.h)),
      w(i32(s.w)),
      co4(i32(blocks4(s.co))),
      ho(i32(s.ho)),
      wo(i32(s.wo)),
      kernel(i32(s.kernel)),
      stride(i32(s.stride)),
      padding(i32(s.padding)),
      dilation(i32(s.dilation)),
      strip_pixels(i32(pixels)),
      step_rows(i32(slab / s.wo % s.ho)),
      step_columns(i32(slab % s.wo)),
      step_images(i32(slab / s.wo / s.ho)) {}

bool can_shared(const Caps& caps) {
  const auto tiles = shared_gradient_tiles();
  return std::any_of(tiles.begin(), tiles.end(),
                     [&](const SharedGradientTile& tile) { return fits(tile, caps); });
}

ConvTuning shared_tuning(const ConvShape& shape, const Caps& caps, ConvStorage storage) {
  return shared_gradient_tuning(tuning_key(kSharedGradient, shape, storage),
                                choose_shared_gradient_tile(work_of(shape), caps), caps);
}

SharedPlan plan_shared(const ConvShape& s, const Caps& caps, ConvStorage storage) {
  const SharedGradientWork work = work_of(s);
  const auto tuned = tuned_shared_gradient_tile(tuning_key(kSharedGradient, s, storage), caps);
  SharedPlan plan{
      .tile = tuned ? *tuned : choose_shared_gradient_tile(work, caps), .strip_pixels = 0, .partial = {}};
  plan.row_groups = ceil_div(work.rows4, plan.tile.tile_rows4());
  plan.column_groups = ceil_div(work.columns4, plan.tile.tile_columns4());
  plan.strip_pixels = strip_of(work.pixels, plan.row_groups * plan.column_groups, plan.tile.depth);
  plan.partial.strips = ceil_div(work.pixels, plan.strip_pixels);
  plan.partial.many_lanes = true;
  return plan;
}

void record_shared(Recorder& recorder, const ConvShape& s, const SharedPlan& plan, const Slice& x,
                   const Slice& dy, const Slice& partial) {
  const SharedGradientTile& tile = plan.tile;
  recorder.dispatch("weight_gradient_shared",
                    {tile.invocations(), tile.rows4, tile.columns4, tile.across, tile.down, tile.depth},
                    {x, dy, partial}, StripPush(s, plan.strip_pixels, tile.depth),
                    {static_cast<uint32_t>(plan.column_groups), static_cast<uint32_t>(plan.row_groups),
                     static_cast<uint32_t>(plan.partial.strips)});
}

}  // namespace vkopple
