#include <algorithm>
#include <bit>
#include <limits>

#include "graph/conv/weight_gradient_partial.h"

namespace vkopple {
namespace {

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }
uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }

/// Sums that a lane may hold, in vectors of 4: more spill too much and take long to compile.
constexpr int64_t kMostSums = 36;
constexpr int64_t kLongestSum = 2048;  ///< pixels that one lane adds one by one
/// Workgroups wanted, for the threads to share, as long as each has this many rounds of its loop.
constexpr int64_t kWantedGroups = 64;
constexpr int64_t kFewestRounds = 128;

struct RegisterPush {
  uint32_t ci, ci4;
  int32_t h, w;
  uint32_t co4, ho, wo;
  int32_t padding, dilation;
  uint32_t image_blocks, strip_blocks, blocks;
};

/// Stride 1 treats both operands alike: with them swapped, the sum gives the same products with taps reversed.
ConvShape swapped(const ConvShape& s) {
  return {s.n,       s.co, s.ho,     s.wo,     s.ci,
          s.h,       s.w,  s.kernel, s.stride, (s.kernel - 1) * s.dilation - s.padding,
          s.dilation};
}

/// A 1x1 kernel that reads x where it lies may take the image for one long row.
bool flattens(const ConvShape& s) {
  return s.kernel == 1 && s.stride == 1 && s.padding == 0 && s.h == s.ho && s.w == s.wo;
}
ConvShape flattened(ConvShape s) {
  s.w *= s.h;
  s.wo = s.w;
  s.h = s.ho = 1;
  return s;
}

int64_t rounds(const RegisterPlan& plan, uint32_t subgroup) {
  return plan.shape.n * ceil_div(plan.shape.ho, subgroup / plan.lanes) * ceil_div(plan.shape.wo, plan.pixels);
}
int64_t lane_groups(const RegisterPlan& plan) { return ceil_div(blocks4(plan.shape.co), plan.lanes); }
int64_t channel_groups(const RegisterPlan& plan) { return ceil_div(plan.shape.ci, plan.channels); }

/// Estimated nanoseconds on one core (8 lanes of a Zen 5 with Mesa 22.3.6): 6 for a fetch, 0.2 for a product or
/// a shuffle, 0.25 for every sum and round, for the mask of the loop.
double cost(const RegisterPlan& plan, uint32_t subgroup) {
  const ConvShape& s = plan.shape;
  const int64_t values = plan.window ? (plan.pixels - 1) * s.stride + s.kernel : plan.pixels;
  const int64_t stretches = s.kernel * (plan.window ? 1 : s.kernel);
  const int64_t fetches = plan.pixels + stretches * blocks4(plan.channels) * ceil_div(values, plan.lanes);
  const int64_t shuffles = plan.lanes == 1 ? 0 : stretches * plan.channels * values;
  const int64_t sums = 4 * plan.channels * s.kernel * s.kernel;
  const double round = 6.0 * static_cast<double>(fetches) +
                       0.2 * static_cast<double>(sums * plan.pixels + shuffles) +
                       0.25 * static_cast<double>(sums);
  return round * static_cast<double>(rounds(plan, subgroup) * lane_groups(plan) * channel_groups(plan));
}

/// The cheapest tile for a shape as it is.
RegisterPlan best_tile(const ConvShape& s, uint32_t subgroup) {
  RegisterPlan best{};
  double least = std::numeric_limits<double>::infinity();
  const int64_t taps = s.kernel * s.kernel;
  for (uint32_t lanes = subgroup; lanes > 0; lanes /= 2)
    for (uint32_t channels = u32(std::min<int64_t>(s.ci, 4)); channels == 4 || channels * taps <= kMostSums;
         channels *= 2) {
      for (uint32_t pixels : {8U, 4U, 2U})
        for (bool window : {true, false}) {
          if (window && s.dilation > 1 && s.kernel > 1) continue;
          const RegisterPlan tile{
              .shape = s, .lanes = lanes, .channels = channels, .pixels = pixels, .window = window};
          const double ns = cost(tile, subgroup);
          if (ns >= least) continue;
          least = ns;
          best = tile;
        }
      if (channels < 4) break;
    }
  return best;
}

void cut_into_strips(RegisterPlan& plan, uint32_t subgroup) {
  const ConvShape& s = plan.shape;
  plan.image_blocks = ceil_div(s.ho, subgroup / plan.lanes);
  const int64_t blocks = s.n * plan.image_blocks;
  const int64_t wanted = std::min(ceil_div(kWantedGroups, lane_groups(plan) * channel_groups(plan)),
                                  rounds(plan, subgroup) / kFewestRounds);
  const int64_t strips = std::max({int64_t{1}, wanted, ceil_div(blocks * s.wo, kLongestSum)});
  plan.strip_blocks = ceil_div(blocks, std::min(strips, blocks));
  plan.partial.strips = ceil_div(blocks, plan.strip_blocks);
}

}  // namespace

bool can_register(const ConvShape& shape, const Caps& caps) {
  // On GPUs a workgroup of the subgroup's size need not be one subgroup.
  return caps.cpu() && caps.subgroup_shuffle && std::has_single_bit(caps.subgroup_size) &&
         caps.subgroup_size <= std::min(128U, caps.max_workgroup_size) && shape.kernel <= 3;
}

RegisterPlan plan_register(const ConvShape& shape, const Caps& caps) {
  const ConvShape s = flattens(shape) ? flattened(shape) : shape;
  RegisterPlan plan = best_tile(s, caps.subgroup_size);
  const auto consider = [&](const ConvShape& other, bool swap) {
    RegisterPlan tile = best_tile(other, caps.subgroup_size);
    tile.swapped = swap;
    if (cost(tile, caps.subgroup_size) < cost(plan, caps.subgroup_size)) plan = tile;
  };
  if (flattens(shape)) consider(shape, false);
  if (s.stride == 1) consider(swapped(s), true);
  plan.partial.lanes_are_out = !plan.swapped;
  plan.partial.flipped = plan.swapped;
  cut_into_strips(plan, caps.subgroup_size);
  return plan;
}

void record_register(Recorder& recorder, const RegisterPlan& plan, const Slice& x, const Slice& dy,
                     const Slice& partial) {
  const ConvShape& s = plan.shape;
  const RegisterPush push{.ci = u32(s.ci),
                          .ci4 = u32(blocks4(s.ci)),
                          .h = static_cast<int32_t>(s.h),
                          .w = static_cast<int32_t>(s.w),
                          .co4 = u32(blocks4(s.co)),
                          .ho = u32(s.ho),
                          .wo = u32(s.wo),
                          .padding = static_cast<int32_t>(s.padding),
                          .dilation = static_cast<int32_t>(s.dilation),
                          .image_blocks = u32(plan.image_blocks),
                          .strip_blocks = u32(plan.strip_blocks),
                          .blocks = u32(s.n * plan.image_blocks)};
  recorder.dispatch("weight_gradient_register",
                    {recorder.caps().subgroup_size, u32(s.kernel), u32(s.stride), plan.lanes, plan.channels,
                     plan.pixels, plan.window ? 1U : 0U},
                    {plan.swapped ? dy : x, plan.swapped ? x : dy, partial}, push,
                    {u32(lane_groups(plan)), u32(channel_groups(plan)), u32(plan.partial.strips)});
}

}  // namespace vkopple
