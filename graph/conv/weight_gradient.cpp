#include "graph/conv/weight_gradient.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/conv/weight_gradient_partial.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

uint32_t u32(int64_t value) { return static_cast<uint32_t>(value); }

WeightGradientKernel choose(const ConvShape& shape, Storage x, Storage dy, const Caps& caps,
                            WeightGradientKernel wanted) {
  if (wanted == WeightGradientKernel::kAuto) {
    const bool float16 = x == Storage::kFloat16 && dy == Storage::kFloat16;
    if (caps.kernels == KernelFamily::kPlain) return WeightGradientKernel::kSimple;
    if (prefers_cooperative(shape, CooperativeUse::kWeightGradient, float16, caps))
      return WeightGradientKernel::kCooperative;
    if (caps.kernels == KernelFamily::kShared || caps.kernels == KernelFamily::kCooperative)
      return WeightGradientKernel::kShared;
    if (can_register(shape, caps)) return WeightGradientKernel::kRegister;
    const bool shared = caps.kernels == KernelFamily::kAuto && !caps.cpu() && can_shared(caps);
    return shared ? WeightGradientKernel::kShared : WeightGradientKernel::kSimple;
  }
  if (!can_weight_gradient(shape, caps, wanted))
    throw Error(fmt::format("{} cannot run the weight gradient kernel asked for on a {}x{} convolution",
                            caps.name, shape.kernel, shape.kernel));
  return wanted;
}

uint64_t partial_bytes(const ConvShape& shape, const WeightGradientPartial& partial) {
  return static_cast<uint64_t>(partial.strips * strip_vectors(shape)) * 16;
}

/// What a kernel's sums of strips take. Each storage may have a tuned tile, whose sums are cut in another way.
WeightGradientPartial partial_of(WeightGradientKernel kernel, const ConvShape& shape, const Caps& caps,
                                 ConvStorage storage) {
  switch (kernel) {
    case WeightGradientKernel::kRegister:
      return plan_register(shape, caps).partial;
    case WeightGradientKernel::kShared:
      return plan_shared(shape, caps, storage).partial;
    case WeightGradientKernel::kCooperative:
      return plan_cooperative(shape, caps, storage).partial;
    default:
      return plan_simple(shape).partial;
  }
}

struct SumPush {
  uint32_t co, ci, lanes, groups, strips, strip_vectors, accumulate;
};

void record_sum(Recorder& recorder, const ConvShape& s, const WeightGradientPartial& partial, const Slice& from,
                const Slice& dw, uint32_t accumulate) {
  if (partial.many_lanes) {
    const SumPush push{u32(s.co), u32(s.ci), u32(blocks4(s.ci)), 0, u32(partial.strips), u32(strip_vectors(s)),
                       accumulate};
    recorder.dispatch_flat("weight_gradient_sum.each", static_cast<uint64_t>(strip_vectors(s)), {from, dw},
                           push, {u32(s.kernel * s.kernel)});
    return;
  }
  const bool vectors = s.ci % 4 == 0;
  const int64_t lanes = blocks4(partial.lanes_are_out ? s.co : s.ci);
  const int64_t channels = partial.lanes_are_out ? s.ci : s.co;
  const int64_t groups = vectors && partial.lanes_are_out ? channels / 4 : channels;
  const SumPush push{u32(s.co), u32(s.ci), u32(lanes), u32(groups), u32(partial.strips), u32(strip_vectors(s)),
                     accumulate};
  recorder.dispatch_flat(
      vectors ? "weight_gradient_sum.vectors" : "weight_gradient_sum.floats",
      static_cast<uint64_t>(groups * lanes), {from, dw}, push,
      {u32(s.kernel * s.kernel), partial.lanes_are_out ? 1U : 0U, partial.flipped ? 1U : 0U});
}

}  // namespace

bool can_weight_gradient(const ConvShape& shape, const Caps& caps, WeightGradientKernel kernel) {
  if (kernel == WeightGradientKernel::kShared) return can_shared(caps);
  if (kernel == WeightGradientKernel::kCooperative)
    return can_cooperative(CooperativeUse::kWeightGradient, caps);
  return kernel != WeightGradientKernel::kRegister || can_register(shape, caps);
}

uint64_t weight_gradient_scratch(const ConvShape& shape, const Caps& caps, WeightGradientKernel kernel) {
  uint64_t bytes = 0;
  for (const Storage x : {Storage::kFloat32, Storage::kFloat16})
    for (const Storage y : {Storage::kFloat32, Storage::kFloat16})
      bytes = std::max(
          bytes, partial_bytes(shape, partial_of(choose(shape, x, y, caps, kernel), shape, caps, {x, y})));
  return bytes;
}

std::optional<ConvTuning> weight_gradient_tuning(const ConvShape& shape, const Caps& caps,
                                                 ConvStorage storage) {
  if (choose(shape, storage.x, storage.y, caps, WeightGradientKernel::kAuto) != WeightGradientKernel::kShared)
    return std::nullopt;
  return shared_tuning(shape, caps, storage);
}

void record_weight_gradient(Recorder& recorder, const ConvShape& shape, Slice x, Slice dy, Slice dw,
                            uint32_t accumulate, Slice scratch, WeightGradientKernel kernel) {
  const Caps& caps = recorder.caps();
  const auto record = [&](const auto& plan, const auto& first_stage) {
    const Slice partial = scratch.sub(0, partial_bytes(shape, plan.partial));
    first_stage(plan, partial);
    record_sum(recorder, shape, plan.partial, partial, dw, accumulate);
  };
  const ConvStorage storage{x.storage, dy.storage};
  switch (choose(shape, x.storage, dy.storage, caps, kernel)) {
    case WeightGradientKernel::kRegister:
      return record(plan_register(shape, caps), [&](const RegisterPlan& plan, const Slice& partial) {
        record_register(recorder, plan, x, dy, partial);
      });
    case WeightGradientKernel::kShared:
      return record(plan_shared(shape, caps, storage), [&](const SharedPlan& plan, const Slice& partial) {
        record_shared(recorder, shape, plan, x, dy, partial);
      });
    case WeightGradientKernel::kCooperative:
      return record(plan_cooperative(shape, caps, storage),
                    [&](const CooperativePlan& plan, const Slice& partial) {
                      record_cooperative(recorder, shape, plan, x, dy, partial);
                    });
    default:
      return record(plan_simple(shape), [&](const SimplePlan& plan, const Slice& partial) {
        record_simple(recorder, shape, plan, x, dy, partial);
      });
  }
}

}  // namespace vkopple
