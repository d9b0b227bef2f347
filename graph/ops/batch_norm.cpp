#include "graph/ops/batch_norm.h"

#include <fmt/format.h>

#include "graph/parallel/host_exchange.h"
#include "graph/parallel/shared_statistics.h"

namespace vkopple {
namespace {

enum Input : size_t { kX, kGamma, kBeta, kMean, kVar, kRandom };

struct FinishPush {
  NormStrips strips;
  float epsilon;
  float momentum;
};

struct GradientsPush {
  NormStrips strips;
  uint32_t flags;
};
constexpr uint32_t kWantsGamma = 1;
constexpr uint32_t kWantsBeta = 2;
constexpr uint32_t kAccumulateGamma = 4;
constexpr uint32_t kAccumulateBeta = 8;

uint32_t gradient_flags(const Backward& io) {
  uint32_t flags = 0;
  if (io.wants(kGamma)) flags |= kWantsGamma | (io.accumulates(kGamma) != 0 ? kAccumulateGamma : 0);
  if (io.wants(kBeta)) flags |= kWantsBeta | (io.accumulates(kBeta) != 0 ? kAccumulateBeta : 0);
  return flags;
}

}  // namespace

BatchNorm::BatchNorm(const BatchNormOptions& options) : options_(options) {
  require(options.eps > 0, fmt::format("eps must be positive, not {}", options.eps));
  require(options.groups >= 1, fmt::format("there must be a group at least, not {}", options.groups));
  require(options.slope > 0 && options.slope <= 1,
          fmt::format("the slope must be in (0, 1], not {}", options.slope));
  require(options.dropout >= 0 && options.dropout < 1,
          fmt::format("the dropout rate must be in [0, 1), not {}", options.dropout));
}

std::vector<TensorSpec> BatchNorm::infer(std::span<const TensorSpec> x) const {
  require(x.size() == (drops() ? 6 : 5),
          "takes x, gamma, beta, running mean and variance, and the random state where it drops");
  require(x[kX].layout == Layout::kChannels4 && x[kX].dtype == DType::kF32, "x must be floats in NC4HW4");
  const Shape& shape = x[kX].shape;
  for (size_t i = kGamma; i <= kVar; ++i)
    require(x[i] == row_major({shape[1]}),
            fmt::format("input {} must be ({}), one number a channel of {}, not {}", i, shape[1], shape.text(),
                        x[i].shape.text()));
  require(!drops() || x[kRandom] == unsigned_ints({2}),
          "the random state must be two unsigned integers, seed and step");
  require(shape[0] % options_.groups == 0,
          fmt::format("{} samples don't make {} groups", shape[0], options_.groups));
  return {x[kX]};
}

Normalise BatchNorm::normalise(const Shape& x, const Caps& caps) const {
  const NormSurround surround{.slope = options_.slope,
                              .dropout = DropoutRate(options_.dropout),
                              .drops = drops(),
                              .stream = options_.stream};
  return {x, options_.groups, surround, caps};
}

Needs BatchNorm::needs(std::span<const TensorSpec> x, const Caps& caps) const {
  const Normalise norm = normalise(x[kX].shape, caps);
  const uint64_t table = aligned(norm.table().bytes());
  return {.saved = {norm.table()},
          .forward_scratch = table + norm.partial_bytes(),
          .backward_scratch = table + norm.partial_bytes(),
          .inputs_for_backward = 1U << kX | (drops() ? 1U << kRandom : 0U),
          .outputs_for_backward = 0};
}

void BatchNorm::record_forward(Recorder& recorder, const Forward& io) const {
  const Normalise norm = normalise(io.x[kX].shape(), recorder.caps());
  const uint64_t table_bytes = norm.table().bytes();
  const Slice partials = io.scratch.sub(aligned(table_bytes), norm.partial_bytes());
  const Slice table = io.saved[0] ? io.saved[0].slice : io.scratch.sub(0, table_bytes);
  if (options_.training) norm.record_statistics(recorder, io.x[kX].slice, partials);
  NormStrips strips = norm.strips();
  if (shares()) {
    record_change(recorder, partials, [peers = options_.peers, strips](std::span<float> values) {
      share_statistics(*peers, strips, values);
    });
    strips = shared_strips(strips, options_.peers->count());
  }
  const FinishPush push{strips, options_.eps, options_.momentum};
  recorder.dispatch("batch_norm_finish", {norm.finish_workgroup(), options_.training ? 1U : 0U},
                    {options_.training ? partials : Slice{}, io.x[kGamma].slice, io.x[kBeta].slice,
                     io.x[kMean].slice, io.x[kVar].slice, table},
                    push, {norm.strips().blocks, 1, 1});
  norm.record_apply(recorder, drops() ? io.x[kRandom].slice : Slice{}, io.x[kX].slice, table, io.y[0].slice);
}

void BatchNorm::record_again(Recorder& recorder, const Forward& io) const {
  normalise(io.x[kX].shape(), recorder.caps())
      .record_apply(recorder, drops() ? io.x[kRandom].slice : Slice{}, io.x[kX].slice, io.saved[0].slice,
                    io.y[0].slice);
}

void BatchNorm::record_backward(Recorder& recorder, const Backward& io) const {
  const Normalise norm = normalise(io.x[kX].shape(), recorder.caps());
  const Slice coefficients = io.scratch.sub(0, norm.table().bytes());
  const Slice partials = io.scratch.sub(aligned(coefficients.bytes), norm.partial_bytes());
  const Slice random = drops() ? io.x[kRandom].slice : Slice{};
  const Slice table = io.saved[0].slice;
  norm.record_reduce(recorder, random, io.x[kX].slice, io.dy[0].slice, table, partials);
  // Sums over the values of all processes, as the mean of a process's: its number of values goes with it.
  if (shares())
    record_change(recorder, partials.sub(0, norm.sum_bytes()),
                  [peers = options_.peers, strips = norm.strips()](std::span<float> values) {
                    share_sums(*peers, strips, values);
                  });
  recorder.dispatch("batch_norm_gradients", {norm.finish_workgroup(), options_.training ? 1U : 0U},
                    {partials, table, coefficients, io.dx[kGamma].slice, io.dx[kBeta].slice},
                    GradientsPush{norm.strips(), gradient_flags(io)}, {norm.strips().blocks, 1, 1});
  if (io.wants(kX))
    norm.record_apply_backward(recorder, random, io.x[kX].slice, coefficients, io.dy[0].slice, io.dx[kX].slice,
                               io.accumulates(kX));
}

Value batch_norm(Value x, Value gamma, Value beta, Value running_mean, Value running_var, Value random,
                 const BatchNormOptions& options) {
  std::vector<Value> inputs{x, gamma, beta, running_mean, running_var};
  if (options.training && options.dropout > 0 && random) inputs.push_back(random);
  return x.graph().apply1(std::make_shared<BatchNorm>(options), inputs);
}

}  // namespace vkopple
