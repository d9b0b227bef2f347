#include "graph/kernels/turn_op.h"

#include <fmt/format.h>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct TurnPush {
  uint32_t objects;
  uint32_t accumulate;
};

/// B, K and then one object's sizes.
Shape of_objects(const Shape& batch_and_slots, const Shape& one) {
  std::vector<int64_t> sizes{batch_and_slots[0], batch_and_slots[1]};
  sizes.insert(sizes.end(), one.sizes().begin(), one.sizes().end());
  return Shape(sizes);
}

uint32_t objects_of(const Operand& x) { return u32(x.shape()[0] * x.shape()[1]); }

}  // namespace

std::vector<TensorSpec> TurnOp::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1, "takes one input");
  const Shape& shape = x[0].shape;
  require(shape.rank() == 2 + from_.rank() && row_floats(x[0], of_objects(shape, from_)),
          fmt::format("takes row-major (B, K, ...) of {} for each object, not {}", from_.text(), shape.text()));
  return {row_major(of_objects(shape, to_))};
}

void TurnOp::record_forward(Recorder& recorder, const Forward& io) const {
  const TurnPush push{objects_of(io.x[0]), 0};
  recorder.dispatch_flat(name_ + ".forward", push.objects, {io.x[0].slice, io.y[0].slice}, push);
}

void TurnOp::record_backward(Recorder& recorder, const Backward& io) const {
  const TurnPush push{objects_of(io.x[0]), io.accumulates(0)};
  recorder.dispatch_flat(name_ + ".backward", push.objects,
                         {io.x[0].slice, io.y[0].slice, io.dy[0].slice, io.dx[0].slice}, push);
}

}  // namespace vkopple
