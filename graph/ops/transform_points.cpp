#include "graph/ops/transform_points.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct TransformPointsPush {
  uint32_t words;
  uint32_t points;  ///< an entry of the batch
  uint32_t accumulate;
};

}  // namespace

std::vector<TensorSpec> TransformPoints::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2 && x[0].layout == Layout::kRowMajor && x[1].layout == Layout::kRowMajor,
          "takes maps and points, row-major");
  const Shape& m = x[0].shape;
  const Shape& points = x[1].shape;
  require(points.rank() == 3 && points[2] == 3 && m == Shape({points[0], 4, 4}),
          fmt::format("takes maps (B, 4, 4) and points (B, K, 3), not {} and {}", m.text(), points.text()));
  return {x[1]};
}

Needs TransformPoints::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 1, .outputs_for_backward = 0};
}

void TransformPoints::record_forward(Recorder& recorder, const Forward& io) const {
  const TransformPointsPush push{words(io.y[0]), u32(io.y[0].shape()[1]), 0};
  recorder.dispatch_flat("transform_points.forward", push.words, {io.x[0].slice, io.x[1].slice, io.y[0].slice},
                         push);
}

void TransformPoints::record_backward(Recorder& recorder, const Backward& io) const {
  const TransformPointsPush push{words(io.dy[0]), u32(io.dy[0].shape()[1]), io.accumulates(1)};
  recorder.dispatch_flat("transform_points.backward", push.words,
                         {io.x[0].slice, io.dy[0].slice, io.dx[1].slice}, push);
}

Value transform_points(Value m, Value x) {
  return x.graph().apply1(std::make_shared<TransformPoints>(), {m, x});
}

}  // namespace vkopple
