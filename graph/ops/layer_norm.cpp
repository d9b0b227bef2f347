#include "graph/ops/layer_norm.h"

#include <fmt/format.h>

namespace vkopple {
namespace {

struct FinishPush {
  NormStrips strips;
  float epsilon;
};

}  // namespace

LayerNorm::LayerNorm(const LayerNormOptions& options) : options_(options) {
  require(options.eps > 0, fmt::format("eps must be positive, not {}", options.eps));
  require(options.slope > 0 && options.slope <= 1,
          fmt::format("the slope must be in (0, 1], not {}", options.slope));
  require(options.dropout >= 0 && options.dropout < 1,
          fmt::format("the dropout rate must be in [0, 1), not {}", options.dropout));
}

std::vector<TensorSpec> LayerNorm::infer(std::span<const TensorSpec> x) const {
  require(x.size() == (drops() ? 2 : 1), "takes x, and the random state where it drops");
  require(x[0].layout == Layout::kChannels4 && x[0].dtype == DType::kF32, "x must be floats in NC4HW4");
  require(!drops() || x[1] == unsigned_ints({2}),
          "the random state must be two unsigned integers, seed and step");
  return {x[0]};
}

Normalise LayerNorm::normalise(const Shape& x, const Caps& caps) const {
  const NormSurround surround{.slope = options_.slope,
                              .dropout = DropoutRate(options_.dropout),
                              .drops = drops(),
                              .stream = options_.stream};
  return {x, x[0], surround, caps};
}

Needs LayerNorm::needs(std::span<const TensorSpec> x, const Caps& caps) const {
  const Normalise norm = normalise(x[0].shape, caps);
  const uint64_t table = aligned(norm.table().bytes());
  return {.saved = {norm.table()},
          .forward_scratch = table + norm.partial_bytes(),
          .backward_scratch = table + norm.partial_bytes(),
          .outputs_for_backward = 0};
}

void LayerNorm::record_forward(Recorder& recorder, const Forward& io) const {
  const Normalise norm = normalise(io.x[0].shape(), recorder.caps());
  const uint64_t table_bytes = norm.table().bytes();
  const Slice partials = io.scratch.sub(aligned(table_bytes), norm.partial_bytes());
  const Slice table = io.saved[0] ? io.saved[0].slice : io.scratch.sub(0, table_bytes);
  norm.record_statistics(recorder, io.x[0].slice, partials);
  recorder.dispatch("layer_norm_finish.forward", {norm.finish_workgroup()}, {partials, table},
                    FinishPush{norm.strips(), options_.eps}, {norm.strips().groups, 1, 1});
  norm.record_apply(recorder, drops() ? io.x[1].slice : Slice{}, io.x[0].slice, table, io.y[0].slice);
}

void LayerNorm::record_again(Recorder& recorder, const Forward& io) const {
  normalise(io.x[0].shape(), recorder.caps())
      .record_apply(recorder, drops() ? io.x[1].slice : Slice{}, io.x[0].slice, io.saved[0].slice,
                    io.y[0].slice);
}

void LayerNorm::record_backward(Recorder& recorder, const Backward& io) const {
  const Normalise norm = normalise(io.x[0].shape(), recorder.caps());
  const Slice coefficients = io.scratch.sub(0, norm.table().bytes());
  const Slice partials = io.scratch.sub(aligned(coefficients.bytes), norm.partial_bytes());
  const Slice random = drops() ? io.x[1].slice : Slice{};
  const Slice table = io.saved[0].slice;
  norm.record_reduce(recorder, random, io.x[0].slice, io.dy[0].slice, table, partials);
  recorder.dispatch("layer_norm_finish.backward", {norm.finish_workgroup()}, {partials, table, coefficients},
                    FinishPush{norm.strips(), options_.eps}, {norm.strips().groups, 1, 1});
  norm.record_apply_backward(recorder, random, io.x[0].slice, coefficients, io.dy[0].slice, io.dx[0].slice,
                             io.accumulates(0));
}

Value layer_norm(Value x, Value random, const LayerNormOptions& options) {
  std::vector<Value> inputs{x};
  if (options.dropout > 0 && random) inputs.push_back(random);
  return x.graph().apply1(std::make_shared<LayerNorm>(options), inputs);
}

}  // namespace vkopple
