#include "graph/ops/decode_location.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct DecodeLocationPush {
  uint32_t count;    ///< slots forward, numbers backward
  uint32_t numbers;  ///< R
  float max_angle;
  float max_depth;
  float max_height;
  uint32_t accumulate;
};

DecodeLocationPush push_of(const LocationRange& range, const Shape& raw) {
  // The angle reaches 20 % beyond the picture.
  return {.count = u32(raw[0] * raw[1]),
          .numbers = u32(raw[2]),
          .max_angle = 0.6F * range.fov,
          .max_depth = range.max_depth,
          .max_height = range.max_height,
          .accumulate = 0};
}

}  // namespace

std::vector<TensorSpec> DecodeLocation::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32,
          "takes one row-major tensor of floats");
  const Shape& shape = x[0].shape;
  require(shape.rank() == 3 && shape[2] >= 3,
          fmt::format("takes raw numbers (B, K, 3 or more), not {}", shape.text()));
  return {row_major({shape[0], shape[1], 3})};
}

Needs DecodeLocation::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.outputs_for_backward = 0};
}

void DecodeLocation::record_forward(Recorder& recorder, const Forward& io) const {
  const DecodeLocationPush push = push_of(range_, io.x[0].shape());
  recorder.dispatch_flat("decode_location.forward", push.count, {io.x[0].slice, io.y[0].slice}, push);
}

void DecodeLocation::record_backward(Recorder& recorder, const Backward& io) const {
  DecodeLocationPush push = push_of(range_, io.x[0].shape());
  push.count *= push.numbers;
  push.accumulate = io.accumulates(0);
  recorder.dispatch_flat("decode_location.backward", push.count,
                         {io.x[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

Value decode_location(Value raw, float fov, float max_depth, float max_height) {
  return raw.graph().apply1(std::make_shared<DecodeLocation>(LocationRange{fov, max_depth, max_height}), {raw});
}

}  // namespace vkopple
