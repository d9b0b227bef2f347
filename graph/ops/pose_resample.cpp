#include "graph/ops/pose_resample.h"

#include <fmt/format.h>

#include "graph/kernels/log_normalise.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct PoseResamplePush {
  uint32_t count;
  uint32_t slots;
  uint32_t bins;
  uint32_t rows;
  uint32_t transposed;
  uint32_t accumulate;
};

PoseResamplePush push_of(const Operand& pose, const Operand& table) {
  return {.count = words(pose),
          .slots = u32(pose.shape()[1]),
          .bins = u32(pose.shape()[2]),
          .rows = u32(table.shape()[0]),
          .transposed = 0,
          .accumulate = 0};
}

}  // namespace

std::vector<TensorSpec> PoseResample::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3 && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32 &&
              x[1].layout == Layout::kRowMajor && x[1].dtype == DType::kF32 && x[2].dtype == DType::kU32,
          "takes log yaw and rows, row-major floats, and indices, unsigned integers");
  const Shape& pose = x[0].shape;
  const Shape& table = x[1].shape;
  require(pose.rank() == 3 && table.rank() == 2 && table[1] == pose[2] && x[2].shape == Shape({pose[0]}),
          fmt::format("takes log yaw (B, K, b), rows (A, b) and indices (B), not {}, {} and {}", pose.text(),
                      table.text(), x[2].shape.text()));
  return {x[0]};
}

Needs PoseResample::needs(std::span<const TensorSpec> x, const Caps&) const {
  const double flop = 2.0 * static_cast<double>(x[0].shape.elements() * x[0].shape[2]);
  return {
      .backward_scratch = x[0].bytes(), .inputs_for_backward = 6, .forward_flop = flop, .backward_flop = flop};
}

void PoseResample::record_forward(Recorder& recorder, const Forward& io) const {
  const PoseResamplePush push = push_of(io.x[0], io.x[1]);
  recorder.dispatch_flat("pose_resample", push.count,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.y[0].slice}, push);
  log_normalise(recorder, io.y[0].slice, push.count / push.bins, push.bins);
}

void PoseResample::record_backward(Recorder& recorder, const Backward& io) const {
  PoseResamplePush push = push_of(io.x[0], io.x[1]);
  push.transposed = 1;
  push.accumulate = io.accumulates(0);
  log_normalise_gradient(recorder, io.y[0].slice, io.dy[0].slice, io.scratch, push.count / push.bins,
                         push.bins);
  recorder.dispatch_flat("pose_resample", push.count,
                         {io.scratch, io.x[1].slice, io.x[2].slice, io.dx[0].slice}, push);
}

Value pose_resample(Value log_p, Value table, Value index) {
  return log_p.graph().apply1(std::make_shared<PoseResample>(), {log_p, table, index});
}

}  // namespace vkopple
