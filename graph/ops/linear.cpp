#include "graph/ops/linear.h"

#include <fmt/format.h>

#include "graph/matmul/linear_product.h"

namespace vkopple {
namespace {

LinearProduct product_of(Recorder& recorder, const Shape& x, const Shape& w) {
  return {recorder, x.product(0, x.rank() - 1), w[1], w[0]};
}

}  // namespace

std::vector<TensorSpec> Linear::infer(std::span<const TensorSpec> x) const {
  require(x.size() == (bias_ ? 3 : 2), "takes x, weights and a bias where there is one");
  for (const TensorSpec& spec : x)
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32,
            "takes row-major floats; use relayout");
  const Shape& in = x[0].shape;
  const Shape& w = x[1].shape;
  require(in.rank() >= 1, "x must have an axis of inputs");
  require(w.rank() == 2 && w[1] == in.back(0),
          fmt::format("x {} needs weights (outputs, {}), not {}", in.text(), in.back(0), w.text()));
  require(!bias_ || x[2].shape == Shape{w[0]}, fmt::format("weights {} need a bias ({})", w.text(), w[0]));
  return {row_major(in.with(in.rank() - 1, w[0]))};
}

Needs Linear::needs(std::span<const TensorSpec> x, const Caps&) const {
  const double flop = 2.0 * static_cast<double>(x[0].shape.elements()) * static_cast<double>(x[1].shape[0]);
  return {.inputs_for_backward = 3, .outputs_for_backward = 0, .forward_flop = flop, .backward_flop = 2 * flop};
}

void Linear::record_forward(Recorder& recorder, const Forward& io) const {
  product_of(recorder, io.x[0].shape(), io.x[1].shape())
      .forward(io.x[0].slice, io.x[1].slice, bias_ ? io.x[2].slice : Slice{}, io.y[0].slice);
}

void Linear::record_backward(Recorder& recorder, const Backward& io) const {
  const LinearProduct product = product_of(recorder, io.x[0].shape(), io.x[1].shape());
  const Slice& dy = io.dy[0].slice;
  if (io.wants(0)) product.dx(dy, io.x[1].slice, io.dx[0].slice, io.accumulates(0));
  if (io.wants(1)) product.dw(dy, io.x[0].slice, io.dx[1].slice, io.accumulates(1));
  if (bias_ && io.wants(2)) product.db(dy, io.dx[2].slice, io.accumulates(2));
}

Value linear(Value x, Value w, Value b) {
  std::vector<Value> inputs{x, w};
  if (b) inputs.push_back(b);
  return x.graph().apply1(std::make_shared<Linear>(static_cast<bool>(b)), inputs);
}

}  // namespace vkopple
