#include "graph/ops/mask_centroid.h"

#include <algorithm>
#include <cmath>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct MaskCentroidPush {
  uint32_t batch;
  uint32_t slots;
  uint32_t pixels;
  uint32_t strip;  ///< pixels of one strip
  uint32_t strips;
  uint32_t want_masks;
  uint32_t want_points;
  uint32_t accumulate_masks;
  uint32_t accumulate_points;
};

MaskCentroidPush push_for(const Shape& masks) {
  const int64_t pixels = masks[2] * masks[3];
  const auto root = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(pixels))));
  const uint32_t strip = std::max(32U, root);
  return {.batch = u32(masks[0]),
          .slots = u32(masks[1] - 1),
          .pixels = u32(pixels),
          .strip = strip,
          .strips = (u32(pixels) + strip - 1) / strip};
}

uint64_t objects(const MaskCentroidPush& push) { return uint64_t{push.batch} * push.slots; }

/// Scratch of forward: sums of strips, and what is saved for backward where nothing is.
struct Room {
  explicit Room(const MaskCentroidPush& push)
      : strips(objects(push) * push.strips * 16), weighed(objects(push) * 16) {}
  uint64_t bytes() const { return aligned(strips) + aligned(weighed); }
  Slice strips_of(const Slice& scratch) const { return scratch.sub(0, strips); }
  Slice weighed_of(const Slice& scratch) const { return scratch.sub(aligned(strips), weighed); }
  uint64_t strips;
  uint64_t weighed;
};

}  // namespace

std::vector<TensorSpec> MaskCentroid::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes two inputs");
  for (const TensorSpec& spec : x)
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32, "takes row-major floats");
  const Shape& masks = x[0].shape;
  const Shape& points = x[1].shape;
  require(masks.rank() == 4 && points.rank() == 4 && masks[1] >= 2 && points == masks.with(1, 3),
          "takes (B, K + 1, H, W) and (B, 3, H, W), not " + masks.text() + " and " + points.text());
  return {row_major({masks[0], masks[1] - 1, 3})};
}

Needs MaskCentroid::needs(std::span<const TensorSpec> x, const Caps&) const {
  const auto push = push_for(x[0].shape);
  return {.saved = {row_major({static_cast<int64_t>(objects(push)), 4})},
          .forward_scratch = Room(push).bytes(),
          .outputs_for_backward = 0};
}

void MaskCentroid::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].shape());
  const Room room(push);
  const Slice strips = room.strips_of(io.scratch);
  const Slice weighed = io.saved[0] ? io.saved[0].slice : room.weighed_of(io.scratch);
  recorder.dispatch_flat("mask_centroid.strips", objects(push) * push.strips,
                         {io.x[0].slice, io.x[1].slice, strips}, push);
  recorder.dispatch_flat("mask_centroid.centroids", objects(push), {strips, weighed, io.y[0].slice}, push);
}

void MaskCentroid::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[0].shape());
  push.want_masks = io.wants(0);
  push.want_points = io.wants(1);
  push.accumulate_masks = io.accumulates(0);
  push.accumulate_points = io.accumulates(1);
  recorder.dispatch_flat(
      "mask_centroid.pixels", uint64_t{push.batch} * push.pixels,
      {io.x[0].slice, io.x[1].slice, io.saved[0].slice, io.dy[0].slice, io.dx[0].slice, io.dx[1].slice}, push);
}

Value mask_centroid(Value masks, Value points) {
  return masks.graph().apply1(std::make_shared<MaskCentroid>(), {masks, points});
}

}  // namespace vkopple
