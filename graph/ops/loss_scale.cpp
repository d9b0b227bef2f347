#include "graph/ops/loss_scale.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/finite_check.h"

namespace vkopple {
namespace {

enum Input : size_t { kState, kFound, kGradients };

struct DecidePush {
  float smallest;
  float largest;
  float interval;
};

bool is_power_of_two(float v) { return v > 0 && std::exp2(std::round(std::log2(v))) == v; }

}  // namespace

LossScale::LossScale(const LossScaleOptions& options) : options_(options) {
  // Other scales would round gradients twice.
  for (float scale : {options.initial, options.smallest, options.largest})
    require(is_power_of_two(scale), fmt::format("scales must be powers of two, not {}", scale));
  require(options.interval >= 1, fmt::format("the interval must be at least 1, not {}", options.interval));
}

std::vector<TensorSpec> LossScale::infer(std::span<const TensorSpec> x) const {
  require(x.size() > kGradients, "takes the state, the flag and at least one gradient");
  require(x[kState] == row_major({kElements}), "the state must be four numbers");
  require(x[kFound] == unsigned_ints({1}), "the flag must be one unsigned integer");
  for (size_t i = kGradients; i < x.size(); ++i)
    require(x[i] == row_major({x[i].shape.elements()}) && x[i].shape.elements() % 4 == 0,
            fmt::format("takes gradients of groups, not {}", x[i].shape.text()));
  return {};
}

Needs LossScale::needs(std::span<const TensorSpec>, const Caps&) const { return {}; }

void LossScale::record_forward(Recorder& recorder, const Forward& io) const {
  recorder.fill(io.x[kFound].slice);
  for (size_t i = kGradients; i < io.x.size(); ++i)
    record_finite_check(recorder, io.x[i].slice, io.x[kFound].slice);
  const DecidePush push{options_.smallest, options_.largest, options_.interval};
  recorder.dispatch_flat("loss_scale.decide", 1, {io.x[kFound].slice, io.x[kState].slice}, push);
}

void LossScale::record_backward(Recorder&, const Backward&) const {}

Value loss_scale(Graph& graph, const std::vector<std::string>& groups, const LossScaleOptions& options) {
  const Value state = graph.state(kLossScaleGroup, kLossScaleState, row_major({LossScale::kElements}));
  const Value found = graph.state(kLossScaleGroup, "loss_scale/found", unsigned_ints({1}));
  std::vector<Value> inputs{state, found};
  for (const std::string& group : groups) inputs.push_back(graph.gradient(group));
  graph.update(std::make_shared<LossScale>(options), inputs);
  return state;
}

}  // namespace vkopple
