#include "graph/conv/weight_gradient.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/error.h"

namespace vkopple {
namespace {

uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }
int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }

/// A choice of kernel and how it cuts the sum; each strip of gradient pixels leaves its sums in scratch.
struct Plan {
  WeightGradientKernel kernel;
  uint32_t lanes;  ///< invocations of a workgroup
  int64_t strips;
  int64_t strip_pixels;
};

/// Vectors of 4 input channels that one strip leaves: [co padded to 4][tap][ci / 4].
int64_t strip_vectors(const ConvShape& s) { return blocks4(s.co) * 4 * s.kernel * s.kernel * blocks4(s.ci); }

Plan plan_simple(const ConvShape& s) {
  constexpr int64_t kLongestSum = 256;  // terms added one by one
  constexpr int64_t kWantedGroups = 4096;
  Plan plan{WeightGradientKernel::kSimple, 64, 1, 0};
  const int64_t pixels = s.n * s.ho * s.wo;
  const int64_t groups = strip_vectors(s) / 4;
  const int64_t wanted = std::min(ceil_div(kWantedGroups, groups), ceil_div(pixels, 4 * plan.lanes));
  const int64_t strips = std::max(wanted, ceil_div(pixels, kLongestSum * plan.lanes));
  plan.strip_pixels = ceil_div(pixels, strips);
  plan.strips = ceil_div(pixels, plan.strip_pixels);
  return plan;
}

Plan plan_of(const ConvShape& shape, const Caps& caps, WeightGradientKernel kernel) {
  if (!can_weight_gradient(shape, caps, kernel))
    throw Error(fmt::format("the wanted weight gradient kernel cannot run on {}", caps.name));
  return plan_simple(shape);
}

struct SimplePush {
  uint32_t n, ci4, h, w, co4, ho, wo, kernel, stride, padding, dilation, strip_pixels;
};

void record_simple(Recorder& recorder, const ConvShape& s, const Plan& plan, Slice x, Slice dy, Slice partial) {
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
                    {ci4 * u32(s.kernel * s.kernel), co4, u32(plan.strips)});
}

struct SumPush {
  uint32_t co, ci, ci4, strips, strip_vectors, accumulate;
};

void record_sum(Recorder& recorder, const ConvShape& s, const Plan& plan, Slice partial, Slice dw,
                uint32_t accumulate) {
  const uint32_t ci4 = u32(blocks4(s.ci));
  const SumPush push{u32(s.co), u32(s.ci), ci4, u32(plan.strips), u32(strip_vectors(s)), accumulate};
  recorder.dispatch_flat(s.ci % 4 == 0 ? "weight_gradient_sum.vectors" : "weight_gradient_sum.floats",
                         push.co * ci4, {partial, dw}, push, {u32(s.kernel * s.kernel)});
}

}  // namespace

bool can_weight_gradient(const ConvShape&, const Caps&, WeightGradientKernel) { return true; }

uint64_t weight_gradient_scratch(const ConvShape& shape, const Caps& caps, WeightGradientKernel kernel) {
  return static_cast<uint64_t>(plan_of(shape, caps, kernel).strips * strip_vectors(shape)) * 16;
}

void record_weight_gradient(Recorder& recorder, const ConvShape& shape, Slice x, Slice dy, Slice dw,
                            uint32_t accumulate, Slice scratch, WeightGradientKernel kernel) {
  const Plan plan = plan_of(shape, recorder.caps(), kernel);
  const Slice partial = scratch.sub(0, weight_gradient_scratch(shape, recorder.caps(), kernel));
  record_simple(recorder, shape, plan, x, dy, partial);
  record_sum(recorder, shape, plan, partial, dw, accumulate);
}

}  // namespace vkopple
