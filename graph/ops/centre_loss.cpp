#include "graph/ops/centre_loss.h"

#include <algorithm>
#include <cmath>

#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct CentreLossPush {
  uint32_t batch;
  uint32_t slots;
  uint32_t pixels;
  uint32_t strip;  ///< pixels of one strip
  uint32_t strips;
  float scale;
  uint32_t want_masks;
  uint32_t want_points;
  uint32_t accumulate_masks;
  uint32_t accumulate_points;
  uint32_t accumulate_location;
};

CentreLossPush push_for(const Shape& masks) {
  const int64_t pixels = masks[2] * masks[3];
  const auto root = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(pixels))));
  const uint32_t strip = std::max(32U, root);
  return {.batch = u32(masks[0]),
          .slots = u32(masks[1] - 1),
          .pixels = u32(pixels),
          .strip = strip,
          .strips = (u32(pixels) + strip - 1) / strip};
}

uint64_t objects(const CentreLossPush& push) { return uint64_t{push.batch} * push.slots; }

/// Scratch of forward: the terms and their sum, sums of strips, and the centres where nothing is saved.
struct Room {
  explicit Room(const CentreLossPush& push)
      : sum(objects(push)), strips(objects(push) * push.strips * 16), centres(objects(push) * 16) {}
  uint64_t bytes() const { return sum.scratch_bytes() + aligned(strips) + aligned(centres); }
  Slice strips_of(const Slice& scratch) const { return scratch.sub(sum.scratch_bytes(), strips); }
  Slice centres_of(const Slice& scratch) const {
    return scratch.sub(sum.scratch_bytes() + aligned(strips), centres);
  }
  TermSum sum;
  uint64_t strips;
  uint64_t centres;
};

}  // namespace

std::vector<TensorSpec> CentreLoss::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  for (const TensorSpec& spec : x)
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32, "takes row-major floats");
  const Shape& masks = x[0].shape;
  const Shape& points = x[1].shape;
  require(masks.rank() == 4 && points.rank() == 4 && masks[1] >= 2 && points == masks.with(1, 3) &&
              x[2].shape == Shape{masks[0], masks[1] - 1, 3},
          "takes (B, K + 1, H, W), (B, 3, H, W) and (B, K, 3), not " + masks.text() + ", " + points.text() +
              " and " + x[2].shape.text());
  return {row_major({1})};
}

Needs CentreLoss::needs(std::span<const TensorSpec> x, const Caps&) const {
  const auto push = push_for(x[0].shape);
  return {.saved = {row_major({static_cast<int64_t>(objects(push)), 4})},
          .forward_scratch = Room(push).bytes(),
          .outputs_for_backward = 0};
}

void CentreLoss::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].shape());
  const Room room(push);
  const Slice strips = room.strips_of(io.scratch);
  const Slice centres = io.saved[0] ? io.saved[0].slice : room.centres_of(io.scratch);
  recorder.dispatch_flat("centre_loss.strips", objects(push) * push.strips,
                         {io.x[0].slice, io.x[1].slice, strips}, push);
  recorder.dispatch_flat("centre_loss.centres", objects(push),
                         {strips, io.x[2].slice, centres, room.sum.terms(io.scratch)}, push);
  room.sum.record(recorder, io.scratch, io.y[0].slice, 1.0F / static_cast<float>(3 * objects(push)));
}

void CentreLoss::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[0].shape());
  push.scale = 2.0F / static_cast<float>(3 * objects(push));
  push.want_masks = io.wants(0);
  push.want_points = io.wants(1);
  push.accumulate_masks = io.accumulates(0);
  push.accumulate_points = io.accumulates(1);
  push.accumulate_location = io.accumulates(2);
  const Slice centres = io.saved[0].slice;
  if (io.wants(2))
    recorder.dispatch_flat("centre_loss.location", 3 * objects(push),
                           {centres, io.x[2].slice, io.dy[0].slice, io.dx[2].slice}, push);
  if (io.wants(0) || io.wants(1))
    recorder.dispatch_flat(
        "centre_loss.pixels", uint64_t{push.batch} * push.pixels,
        {io.x[0].slice, io.x[1].slice, centres, io.x[2].slice, io.dy[0].slice, io.dx[0].slice, io.dx[1].slice},
        push);
}

Value centre_loss(Value masks, Value points, Value location) {
  return masks.graph().apply1(std::make_shared<CentreLoss>(), {masks, points, location});
}

}  // namespace vkopple
