#include "graph/ops/lstm.h"

#include <fmt/format.h>

#include <utility>

#include "graph/kernels/words.h"
#include "graph/matmul/linear_product.h"

namespace vkopple {
namespace {

enum Input : size_t { kX, kWih, kWhh, kBih, kBhh };

struct Sizes {
  int64_t batch;
  int64_t inputs;
  int64_t size;  ///< of the hidden state, H
  int64_t steps;
  int64_t cells() const { return batch * size; }  ///< of one step
};

Sizes sizes_of(const Shape& x, const Shape& w_hh, int64_t steps) { return {x[0], x[1], w_hh[1], steps}; }

struct StepPush {
  uint32_t batch;
  uint32_t size;
  uint32_t steps;
  uint32_t step;
};

StepPush step_push(const Sizes& s, int64_t step) {
  return {u32(s.batch), u32(s.size), u32(s.steps), u32(step)};
}

/// Cuts scratch memory into float tensors one after the other.
class Cutter {
 public:
  explicit Cutter(Slice slice = {}) : slice_(slice) {}
  Slice take(int64_t elements) {
    const uint64_t bytes = static_cast<uint64_t>(elements) * 4;
    const uint64_t begin = std::exchange(used_, used_ + aligned(bytes));
    return slice_ ? slice_.sub(begin, bytes) : Slice{};
  }
  uint64_t used() const { return used_; }

 private:
  Slice slice_;
  uint64_t used_ = 0;
};

/// What backward needs, all with the step outermost.
struct History {
  Slice gates;   ///< (steps, B, 4H), after their activations
  Slice cells;   ///< (steps, B, H)
  Slice hidden;  ///< (steps, B, H)
};

struct ForwardScratch {
  Slice input_part;   ///< x w_ihᵀ, (B, 4H)
  Slice hidden_part;  ///< h w_hhᵀ, (B, 4H)
  History history;    ///< where nothing is saved

  ForwardScratch(Cutter& cutter, const Sizes& s)
      : input_part(cutter.take(4 * s.cells())),
        hidden_part(cutter.take(4 * s.cells())),
        history{cutter.take(s.steps * 4 * s.cells()), cutter.take(s.steps * s.cells()),
                cutter.take(s.steps * s.cells())} {}
};

struct BackwardScratch {
  Slice da;      ///< gradient of the gates before their activations, (steps, B, 4H)
  Slice da_sum;  ///< its sum over the steps, (B, 4H)
  Slice dh;      ///< (B, H)
  Slice dc;      ///< (B, H)

  BackwardScratch(Cutter& cutter, const Sizes& s)
      : da(cutter.take(s.steps * 4 * s.cells())),
        da_sum(cutter.take(4 * s.cells())),
        dh(cutter.take(s.cells())),
        dc(cutter.take(s.cells())) {}
};

/// da of every step, and its sum.
void record_steps_back(Recorder& recorder, const Sizes& s, const Backward& io, const BackwardScratch& scratch) {
  for (int64_t t = s.steps; t-- > 0;) {
    recorder.dispatch_flat("lstm.backward", static_cast<uint64_t>(s.cells()),
                           {io.dy[0].slice, scratch.dh, io.saved[0].slice, io.saved[1].slice, scratch.da,
                            scratch.da_sum, scratch.dc},
                           step_push(s, t));
    if (t > 0)
      LinearProduct(recorder, s.batch, s.size, 4 * s.size, 0, t * 4 * s.cells())
          .dx(scratch.da, io.x[kWhh].slice, scratch.dh, 0);
  }
}

/// Σ over the steps but the first of daᵀ h of the step before: one product over all their rows.
void record_hidden_weights(Recorder& recorder, const Sizes& s, const Backward& io, const Slice& da) {
  const Slice& dw = io.dx[kWhh].slice;
  if (s.steps > 1)
    LinearProduct(recorder, (s.steps - 1) * s.batch, s.size, 4 * s.size, 0, 4 * s.cells())
        .dw(da, io.saved[2].slice, dw, io.accumulates(kWhh));
  else if (io.accumulates(kWhh) == 0)
    recorder.fill(dw);
}

}  // namespace

Lstm::Lstm(int64_t steps) : steps_(steps) {
  require(steps >= 1, fmt::format("takes a step at least, not {}", steps));
}

std::vector<TensorSpec> Lstm::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 5, "takes x, two weights and two biases");
  for (const TensorSpec& spec : x)
    require(spec.layout == Layout::kRowMajor && spec.dtype == DType::kF32,
            "takes row-major floats; use relayout");
  const Shape& in = x[kX].shape;
  const Shape& w = x[kWih].shape;
  require(in.rank() == 2, fmt::format("x must be (batch, inputs), not {}", in.text()));
  require(w.rank() == 2 && w[0] % 4 == 0 && w[1] == in[1],
          fmt::format("x {} needs input weights (4 hidden, {}), not {}", in.text(), in[1], w.text()));
  const int64_t size = w[0] / 4;
  require(x[kWhh].shape == Shape{4 * size, size},
          fmt::format("input weights {} need hidden weights ({}, {}), not {}", w.text(), 4 * size, size,
                      x[kWhh].shape.text()));
  for (size_t i : {kBih, kBhh})
    require(x[i].shape == Shape{4 * size},
            fmt::format("input weights {} need biases ({}), not {}", w.text(), 4 * size, x[i].shape.text()));
  return {row_major({in[0], steps_, size})};
}

Needs Lstm::needs(std::span<const TensorSpec> x, const Caps&) const {
  const Sizes s = sizes_of(x[kX].shape, x[kWhh].shape, steps_);
  Cutter forward;
  Cutter backward;
  ForwardScratch(forward, s);
  BackwardScratch(backward, s);
  const double flop =
      8.0 * static_cast<double>(s.cells()) * static_cast<double>(s.inputs + (s.steps - 1) * s.size);
  return {.saved = {row_major({s.steps, s.batch, 4 * s.size}), row_major({s.steps, s.batch, s.size}),
                    row_major({s.steps, s.batch, s.size})},
          .forward_scratch = forward.used(),
          .backward_scratch = backward.used(),
          .inputs_for_backward = 1U << kX | 1U << kWih | 1U << kWhh,
          .outputs_for_backward = 0,
          .forward_flop = flop,
          .backward_flop = 2 * flop};
}

void Lstm::record_forward(Recorder& recorder, const Forward& io) const {
  const Sizes s = sizes_of(io.x[kX].shape(), io.x[kWhh].shape(), steps_);
  Cutter cutter(io.scratch);
  const ForwardScratch scratch(cutter, s);
  const History history =
      io.saved[0] ? History{io.saved[0].slice, io.saved[1].slice, io.saved[2].slice} : scratch.history;
  LinearProduct(recorder, s.batch, s.inputs, 4 * s.size)
      .forward(io.x[kX].slice, io.x[kWih].slice, {}, scratch.input_part);
  for (int64_t t = 0; t < s.steps; ++t) {
    if (t > 0)
      LinearProduct(recorder, s.batch, s.size, 4 * s.size, (t - 1) * s.cells(), 0)
          .forward(history.hidden, io.x[kWhh].slice, {}, scratch.hidden_part);
    recorder.dispatch_flat("lstm.forward", static_cast<uint64_t>(s.cells()),
                           {scratch.input_part, scratch.hidden_part, io.x[kBih].slice, io.x[kBhh].slice,
                            history.gates, history.cells, history.hidden, io.y[0].slice},
                           step_push(s, t));
  }
}

void Lstm::record_backward(Recorder& recorder, const Backward& io) const {
  const Sizes s = sizes_of(io.x[kX].shape(), io.x[kWhh].shape(), steps_);
  Cutter cutter(io.scratch);
  const BackwardScratch scratch(cutter, s);
  record_steps_back(recorder, s, io, scratch);
  // The same input entered every step, so that its part needs the sum alone.
  const LinearProduct input(recorder, s.batch, s.inputs, 4 * s.size);
  if (io.wants(kX)) input.dx(scratch.da_sum, io.x[kWih].slice, io.dx[kX].slice, io.accumulates(kX));
  if (io.wants(kWih)) input.dw(scratch.da_sum, io.x[kX].slice, io.dx[kWih].slice, io.accumulates(kWih));
  if (io.wants(kWhh)) record_hidden_weights(recorder, s, io, scratch.da);
  for (size_t i : {kBih, kBhh})
    if (io.wants(i)) input.db(scratch.da_sum, io.dx[i].slice, io.accumulates(i));
}

Value lstm(Value x, Value w_ih, Value w_hh, Value b_ih, Value b_hh, int64_t steps) {
  return x.graph().apply1(std::make_shared<Lstm>(steps), {x, w_ih, w_hh, b_ih, b_hh});
}

}  // namespace vkopple
