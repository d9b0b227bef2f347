#include "graph/ops/adam.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"
#include "graph/ops/loss_scale.h"

namespace vkopple {
namespace {

enum Input : size_t { kParameters, kGradient, kM, kV, kCorrection, kRate, kScale };

struct CorrectionPush {
  float beta1;
  float beta2;
  float rest1;  ///< 1 − beta1, from double: float32 would lose digits
  float rest2;
};

struct AdamPush {
  uint32_t vectors;
  float beta1;
  float beta2;
  float rest1;
  float rest2;
  float epsilon;
  float clip;
};

bool is_decay(double beta) { return beta >= 0 && beta < 1; }

}  // namespace

Adam::Adam(const AdamOptions& options) : options_(options) {
  require(is_decay(options.beta1) && is_decay(options.beta2),
          fmt::format("the betas must be in [0, 1), not {} and {}", options.beta1, options.beta2));
  require(options.epsilon > 0, fmt::format("epsilon must be positive, not {}", options.epsilon));
  require(options.clip > 0, fmt::format("the clip must be positive, not {}", options.clip));
}

std::vector<TensorSpec> Adam::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 6 || x.size() == 7,
          "takes parameters, gradient, m, v, the corrections, the learning rate, and perhaps the state of a "
          "loss scale");
  require(x.size() == 6 || x[kScale] == row_major({LossScale::kElements}),
          "the state of the loss scale must be four numbers");
  const TensorSpec& flat = x[kParameters];
  require(flat == row_major({flat.shape.elements()}) && flat.shape.elements() % 4 == 0,
          fmt::format("takes a group's flat tensor, not {}", flat.shape.text()));
  for (size_t i : {kGradient, kM, kV})
    require(x[i] == flat, fmt::format("input {} must be as large as the parameters {}, not {}", i,
                                      flat.shape.text(), x[i].shape.text()));
  require(x[kCorrection] == row_major({2}), "the corrections must be two numbers");
  require(x[kRate] == row_major({1}), "the learning rate must be one number");
  return {};
}

Needs Adam::needs(std::span<const TensorSpec>, const Caps&) const { return {}; }

void Adam::record_forward(Recorder& recorder, const Forward& io) const {
  const auto f32 = [](double v) { return static_cast<float>(v); };
  const CorrectionPush correction{f32(options_.beta1), f32(options_.beta2), f32(1 - options_.beta1),
                                  f32(1 - options_.beta2)};
  const Slice scale = io.x.size() > kScale ? io.x[kScale].slice : Slice{};
  const uint32_t scaled = scale ? 1 : 0;
  recorder.dispatch_flat("adam.correction", 1, {io.x[kCorrection].slice, scale}, correction, {scaled});
  const AdamPush push{.vectors = words(io.x[kParameters]) / 4,
                      .beta1 = correction.beta1,
                      .beta2 = correction.beta2,
                      .rest1 = correction.rest1,
                      .rest2 = correction.rest2,
                      .epsilon = f32(options_.epsilon),
                      .clip = f32(options_.clip)};
  const Slice parameters = io.x[kParameters].slice;
  const Slice m = io.x[kM].slice;
  const Slice v = io.x[kV].slice;
  // Where a factor may say that nothing is to change, nothing is stored by rows.
  recorder.dispatch_units("adam.apply", push.vectors, {.allowed = scaled == 0, .tensors = 3},
                          {io.x[kGradient].slice, io.x[kCorrection].slice, parameters, m, v, scale, parameters,
                           m, v, io.x[kRate].slice},
                          push, {scaled});
}

void Adam::record_backward(Recorder&, const Backward&) const {}

void adam(Graph& graph, const std::string& group, const AdamOptions& options, Value rate, Value scale) {
  const Value parameters = graph.group(group);
  const Value gradient = graph.gradient(group);
  const std::string state = "adam/" + group;
  const Value m = graph.state(state, state + "/m", parameters.spec());
  const Value v = graph.state(state, state + "/v", parameters.spec());
  const Value correction = graph.state(state, state + "/correction", row_major({2}));
  std::vector<Value> inputs{parameters, gradient, m, v, correction, rate};
  if (scale) inputs.push_back(scale);
  graph.update(std::make_shared<Adam>(options), inputs);
}

Value learning_rate(Graph& graph) { return graph.input("learning_rate", row_major({1})); }

}  // namespace vkopple
