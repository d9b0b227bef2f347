#include "graph/ops/image_loss.h"

#include <algorithm>
#include <cmath>

#include "graph/kernels/term_sum.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct ImageLossPush {
  uint32_t units;
  uint32_t strip;  ///< units of one strip
  uint32_t strips;
  float scale;
  uint32_t accumulate;
};

bool wide(const TensorSpec& spec) { return words(spec) % 4 == 0; }

ImageLossPush push_for(const TensorSpec& spec) {
  const uint32_t units = words(spec) / (wide(spec) ? 4 : 1);
  const auto root = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(units))));
  const uint32_t strip = std::max(32U, root);
  return {.units = units, .strip = strip, .strips = (units + strip - 1) / strip, .scale = 1, .accumulate = 0};
}

}  // namespace

std::vector<TensorSpec> ImageLoss::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes two inputs");
  require(x[0] == x[1] && x[0].dtype == DType::kF32 && x[0].shape.rank() == 4,
          "takes two images of one shape and layout, not " + x[0].shape.text() + " and " + x[1].shape.text());
  return {row_major({1})};
}

Needs ImageLoss::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.forward_scratch = TermSum(push_for(x[0]).strips).scratch_bytes(), .outputs_for_backward = 0};
}

void ImageLoss::record_forward(Recorder& recorder, const Forward& io) const {
  const auto push = push_for(io.x[0].spec);
  const TermSum sum(push.strips);
  recorder.dispatch_flat(wide(io.x[0].spec) ? "image_loss.forward4" : "image_loss.forward", push.strips,
                         {io.x[0].slice, io.x[1].slice, sum.terms(io.scratch)}, push);
  sum.record(recorder, io.scratch, io.y[0].slice, 1.0F / static_cast<float>(io.x[0].shape()[0]));
}

void ImageLoss::record_backward(Recorder& recorder, const Backward& io) const {
  auto push = push_for(io.x[0].spec);
  push.scale = 2.0F / static_cast<float>(io.x[0].shape()[0]);
  push.accumulate = io.accumulates(0);
  recorder.dispatch_flat(wide(io.x[0].spec) ? "image_loss.backward4" : "image_loss.backward",
                         (push.units + 3) / 4, {io.x[0].slice, io.x[1].slice, io.dy[0].slice, io.dx[0].slice},
                         push);
}

Value image_loss(Value predicted, Value target) {
  return predicted.graph().apply1(std::make_shared<ImageLoss>(), {predicted, target});
}

}  // namespace vkopple
