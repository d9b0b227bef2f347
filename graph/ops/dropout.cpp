#include "graph/ops/dropout.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

/// Words that one invocation takes, in pieces of 4; enough that its key costs little beside them.
constexpr uint64_t kWordsEach = 32;

struct DropoutPush {
  uint32_t words;
  uint32_t stream;
  uint32_t threshold;
  float scale;
  uint32_t accumulate;
};

}  // namespace

Dropout::Dropout(float rate, uint32_t stream) : rate_(rate), stream_(stream) {
  require(rate >= 0 && rate < 1, fmt::format("the rate must be in [0, 1), not {}", rate));
}

std::vector<TensorSpec> Dropout::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2, "takes x and the random state");
  require(x[0].dtype == DType::kF32, "x must hold floats");
  require(x[1] == unsigned_ints({2}), "the random state must be two unsigned integers, seed and step");
  return {x[0]};
}

Needs Dropout::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 2, .outputs_for_backward = 0};
}

void Dropout::record(Recorder& recorder, const Operand& from, const Operand& random, const Operand& to,
                     uint32_t accumulate) const {
  const DropoutRate rate(rate_);
  const DropoutPush push{words(from), stream_, rate.threshold, rate.scale, accumulate};
  // Whole vectors where the size allows; the unused bindings stay empty.
  const bool vectors = push.words % 4 == 0;
  const Slice none;
  recorder.dispatch_flat("dropout", (push.words + kWordsEach - 1) / kWordsEach,
                         {random.slice, vectors ? from.slice : none, vectors ? to.slice : none,
                          vectors ? none : from.slice, vectors ? none : to.slice},
                         push, {vectors ? 1U : 0U});
}

void Dropout::record_forward(Recorder& recorder, const Forward& io) const {
  record(recorder, io.x[0], io.x[1], io.y[0], 0);
}

void Dropout::record_backward(Recorder& recorder, const Backward& io) const {
  record(recorder, io.dy[0], io.x[1], io.dx[0], io.accumulates(0));
}

Value dropout(Value x, Value random, float rate, uint32_t stream) {
  if (rate == 0) return x;
  return x.graph().apply1(std::make_shared<Dropout>(rate, stream), {x, random});
}

}  // namespace vkopple
