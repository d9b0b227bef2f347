#include "graph/ops/weighted_sum.h"

#include <fmt/format.h>

#include <algorithm>

#include "graph/kernels/add_scaled.h"
#include "graph/kernels/words.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

struct WeightedSumPush {
  uint32_t count;
  std::array<float, WeightedSum::kMostInputs> weights;
};

}  // namespace

std::vector<TensorSpec> WeightedSum::infer(std::span<const TensorSpec> x) const {
  require(!x.empty() && x.size() <= kMostInputs && x.size() == weights_.size(),
          fmt::format("takes 1 to {} inputs and as many weights, not {} and {}", kMostInputs, x.size(),
                      weights_.size()));
  for (const TensorSpec& spec : x)
    require(spec == row_major({1}), "takes tensors of shape (1), not " + spec.shape.text());
  return {row_major({1})};
}

Needs WeightedSum::needs(std::span<const TensorSpec>, const Caps&) const {
  return {.inputs_for_backward = 0, .outputs_for_backward = 0};
}

void WeightedSum::record_forward(Recorder& recorder, const Forward& io) const {
  WeightedSumPush push{.count = u32(io.x.size()), .weights = {}};
  std::copy(weights_.begin(), weights_.end(), push.weights.begin());
  std::array<Slice, kMostInputs> x{};
  for (size_t i = 0; i < io.x.size(); ++i) x[i] = io.x[i].slice;
  recorder.dispatch_flat("weighted_sum", 1, {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], io.y[0].slice},
                         push);
}

void WeightedSum::record_backward(Recorder& recorder, const Backward& io) const {
  for (size_t i = 0; i < weights_.size(); ++i)
    if (io.wants(i)) add_scaled(recorder, io.dy[0], io.dx[i], weights_[i], io.accumulates(i) != 0);
}

Value weighted_sum(const std::vector<Value>& scalars, const std::vector<float>& weights) {
  if (scalars.empty()) throw Error("[weighted_sum] takes 1 to 8 inputs");
  return scalars[0].graph().apply1(std::make_shared<WeightedSum>(weights), scalars);
}

}  // namespace vkopple
