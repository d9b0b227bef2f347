#include <algorithm>

#include "graph/conv/weight_gradient_partial.h"

namespace vkopple {
namespace {

constexpr int64_t kLongestSum = 256;     ///< terms that one invocation adds one by one
constexpr int64_t kShortestSum = 4;      ///< below, more strips would not pay
constexpr int64_t kWantedGroups = 4096;  ///< enough workgroups for a large GPU

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }
uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }

struct SimplePush {
  uint32_t n, ci4, h, w, co4, ho, wo, kernel, stride, padding, dilation, strip_pixels;
};

}  // namespace

SimplePlan plan_simple(const ConvShape& s) {
  SimplePlan plan{.lanes = 64, .strip_pixels = 0, .partial = {}};
  const int64_t pixels = s.n * s.ho * s.wo;
  const int64_t groups = strip_vectors(s) / 4;
  const int64_t wanted = std::min(ceil_div(kWantedGroups, groups), ceil_div(pixels, kShortestSum * plan.lanes));
  const int64_t strips = std::max(wanted, ceil_div(pixels, kLongestSum * plan.lanes));
  plan.strip_pixels = ceil_div(pixels, strips);
  plan.partial.strips = ceil_div(pixels, plan.strip_pixels);
  return plan;
}

void record_simple(Recorder& recorder, const ConvShape& s, const SimplePlan& plan, const Slice& x,
                   const Slice& dy, const Slice& partial) {
  const uint32_t ci4 = u32(blocks4(s.ci));
  const uint32_t co4 = u32(blocks4(s.co));
  const SimplePush push{u32(s.n),
                        ci4,
                        u32(s.h),
                        u32(s.w),
                        co4,
                        u32(s.ho),
                        u32(s.wo),
                        u32(s.kernel),
                        u32(s.stride),
                        u32(s.padding),
                        u32(s.dilation),
                        u32(plan.strip_pixels)};
  recorder.dispatch("weight_gradient_simple", {plan.lanes}, {x, dy, partial}, push,
                    {ci4 * u32(s.kernel * s.kernel), co4, u32(plan.partial.strips)});
}

}  // namespace vkopple
