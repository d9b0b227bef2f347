#include "graph/ops/align.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/kernels/log_normalise.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct AlignPush {
  uint32_t count;
  uint32_t slots;
  uint32_t width;  ///< of an object's row: 3 or the bins
  uint32_t accumulate;
};

AlignPush push_of(const Operand& of, uint32_t accumulate = 0) {
  return {words(of), u32(of.shape()[1]), u32(of.shape()[2]), accumulate};
}

/// Backward's scratch: the gradient of the yaw before its normalisation (B, K, b), and its shares (B, K, K, b).
uint64_t unnormalised_bytes(const Shape& pose) { return aligned(static_cast<uint64_t>(pose.elements()) * 4); }
uint64_t share_bytes(const Shape& pose) { return static_cast<uint64_t>(pose.elements() * pose[1]) * 4; }

}  // namespace

std::vector<TensorSpec> Align::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3 && std::all_of(x.begin(), x.end(),
                                       [](const TensorSpec& s) {
                                         return s.layout == Layout::kRowMajor && s.dtype == DType::kF32;
                                       }),
          "takes log w, location and log yaw, row-major floats");
  const Shape& w = x[0].shape;
  const Shape& pose = x[2].shape;
  require(w.rank() == 3 && w[1] == w[2] && x[1].shape == Shape({w[0], w[1], 3}) && pose.rank() == 3 &&
              pose[0] == w[0] && pose[1] == w[1],
          fmt::format("takes log w (B, K, K), location (B, K, 3) and log yaw (B, K, b), not {}, {} and {}",
                      w.text(), x[1].shape.text(), pose.text()));
  return {x[1], x[2]};
}

Needs Align::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.backward_scratch = unnormalised_bytes(x[2].shape) + share_bytes(x[2].shape),
          .outputs_for_backward = 2};
}

void Align::record_forward(Recorder& recorder, const Forward& io) const {
  const AlignPush location = push_of(io.y[0]);
  recorder.dispatch_flat("align.location", location.count, {io.x[0].slice, io.x[1].slice, io.y[0].slice},
                         location);
  const AlignPush pose = push_of(io.y[1]);
  recorder.dispatch_flat("align.pose", pose.count, {io.x[0].slice, io.x[2].slice, io.y[1].slice}, pose,
                         {pose.slots});
  log_normalise(recorder, io.y[1].slice, pose.count / pose.width, pose.width);
}

void Align::record_backward(Recorder& recorder, const Backward& io) const {
  const AlignPush pose = push_of(io.y[1]);
  const Slice unnormalised = io.scratch.sub(0, io.y[1].spec.bytes());
  const Slice shares = io.scratch.sub(unnormalised_bytes(io.y[1].shape()), share_bytes(io.y[1].shape()));
  if (io.wants(0) || io.wants(2)) {
    log_normalise_gradient(recorder, io.y[1].slice, io.dy[1].slice, unnormalised, pose.count / pose.width,
                           pose.width);
    recorder.dispatch_flat("align.shares", pose.count, {io.x[0].slice, io.x[2].slice, unnormalised, shares},
                           pose, {pose.slots});
  }
  if (io.wants(0)) {
    const AlignPush weights{words(io.x[0]), pose.slots, pose.width, io.accumulates(0)};
    recorder.dispatch_flat("align.d_weights", weights.count,
                           {io.x[0].slice, io.x[1].slice, io.dy[0].slice, shares, io.dx[0].slice}, weights);
  }
  if (io.wants(1)) {
    const AlignPush location = push_of(io.x[1], io.accumulates(1));
    recorder.dispatch_flat("align.d_location", location.count, {io.x[0].slice, io.dy[0].slice, io.dx[1].slice},
                           location);
  }
  if (io.wants(2)) {
    const AlignPush d_pose = push_of(io.x[2], io.accumulates(2));
    recorder.dispatch_flat("align.d_pose", d_pose.count, {shares, io.dx[2].slice}, d_pose);
  }
}

std::vector<Value> align(Value log_w, Value location, Value log_pose) {
  return log_w.graph().apply(std::make_shared<Align>(), {log_w, location, log_pose});
}

}  // namespace vkopple
