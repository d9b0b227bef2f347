#include "graph/kernels/strided_sum.h"

#include <algorithm>
#include <cmath>

#include "graph/kernels/words.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// Sums up to this length are left to one invocation.
constexpr uint64_t kShortSum = 512;

struct StridedSumPush {
  uint32_t kept;
  uint32_t summed;
  uint32_t strip;
  uint32_t strips;
  uint32_t kept_axes;
  uint32_t axes;
  float scale;
  uint32_t accumulate;
  std::array<uint32_t, Shape::kMaxRank> sizes;
  std::array<uint32_t, Shape::kMaxRank> x_strides;
  std::array<uint32_t, Shape::kMaxRank> w_strides;
};

/// Adds an axis below the others, merged with the last one where both together step evenly.
void append(std::vector<StridedSum::Axis>& axes, const StridedSum::Axis& axis) {
  if (!axes.empty()) {
    auto& last = axes.back();
    if (last.x_stride == axis.size * axis.x_stride && last.w_stride == axis.size * axis.w_stride) {
      last.size *= axis.size;
      last.x_stride = axis.x_stride;
      last.w_stride = axis.w_stride;
      return;
    }
  }
  axes.push_back(axis);
}

}  // namespace

StridedSum::StridedSum(const std::vector<Axis>& axes) {
  if (axes.size() > Shape::kMaxRank) throw Error("a sum over a space of more than 6 axes");
  for (const Axis& axis : axes) {
    if (axis.size == 1) continue;
    append(axis.summed ? summed_ : kept_, axis);
    (axis.summed ? summed_elements_ : kept_elements_) *= static_cast<uint64_t>(axis.size);
  }
  strip_ = summed_elements_;
  if (summed_elements_ > kShortSum) {
    const auto root = static_cast<uint64_t>(std::ceil(std::sqrt(static_cast<double>(summed_elements_))));
    strip_ = std::max<uint64_t>(64, root);
    strips_ = (summed_elements_ + strip_ - 1) / strip_;
  }
}

uint64_t StridedSum::scratch_bytes() const { return strips_ > 1 ? kept_elements_ * strips_ * 4 : 0; }

void StridedSum::record(Recorder& recorder, const Slice& x, const Slice& w, const Slice& y,
                        const Slice& scratch, float scale, bool accumulate) const {
  const bool two_stages = strips_ > 1;
  StridedSumPush push{.kept = u32(kept_elements_),
                      .summed = u32(summed_elements_),
                      .strip = u32(strip_),
                      .strips = u32(strips_),
                      .kept_axes = u32(kept_.size()),
                      .axes = u32(kept_.size() + summed_.size()),
                      .scale = two_stages ? 1.0F : scale,
                      .accumulate = !two_stages && accumulate,
                      .sizes = {},
                      .x_strides = {},
                      .w_strides = {}};
  size_t next = 0;
  for (const auto* axes : {&kept_, &summed_})
    for (const Axis& axis : *axes) {
      push.sizes[next] = u32(axis.size);
      push.x_strides[next] = u32(axis.x_stride);
      push.w_strides[next++] = u32(axis.w_stride);
    }
  const uint32_t weighted = w ? 1 : 0;
  recorder.dispatch_flat("strided_sum", kept_elements_ * strips_, {x, w, two_stages ? scratch : y}, push,
                         {weighted});
  if (!two_stages) return;
  const StridedSumPush last{.kept = push.kept,
                            .summed = push.strips,
                            .strip = push.strips,
                            .strips = 1,
                            .kept_axes = 1,
                            .axes = 2,
                            .scale = scale,
                            .accumulate = accumulate,
                            .sizes = {push.kept, push.strips},
                            .x_strides = {1, push.kept},
                            .w_strides = {}};
  recorder.dispatch_flat("strided_sum", kept_elements_, {scratch, {}, y}, last, {0});
}

std::vector<int64_t> broadcast_strides(const Shape& tensor, const Shape& space) {
  std::vector<int64_t> strides(space.rank(), 0);
  int64_t stride = 1;
  for (size_t i = 0; i < tensor.rank(); ++i) {
    if (tensor.back(i) > 1) strides[space.rank() - 1 - i] = stride;
    stride *= tensor.back(i);
  }
  return strides;
}

StridedSum sum_of_all(uint64_t count) {
  return StridedSum({{.size = static_cast<int64_t>(count), .summed = true, .x_stride = 1, .w_stride = 0}});
}

}  // namespace vkopple
