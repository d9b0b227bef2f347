#include "graph/ops/adam.h"

#include <fmt/format.h>

namespace vkopple {
namespace {

struct CorrectionPush {
  float beta1;
  float beta2;
};

struct AdamPush {
  uint32_t count;
  float learning_rate;
  float beta1;
  float beta2;
  float epsilon;
  float clip;
};

}  // namespace

std::vector<TensorSpec> Adam::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 5, "takes parameters, gradient, m, v and correction");
  for (size_t i = 1; i < 4; ++i)
    require(
        x[i] == x[0] && x[0].layout == Layout::kRowMajor,
        fmt::format("parameters {} and input {} of shape {} differ", x[0].shape.text(), i, x[i].shape.text()));
  require(x[4] == row_major({2}), "the correction has shape (2), not " + x[4].shape.text());
  return {};
}

Needs Adam::needs(std::span<const TensorSpec>, const Caps&) const { return {}; }

void Adam::record_forward(Recorder& recorder, const Forward& io) const {
  const CorrectionPush correction{options_.beta1, options_.beta2};
  recorder.dispatch("adam_correction", {1}, {io.x[4].slice}, correction, {1, 1, 1});
  const AdamPush push{static_cast<uint32_t>(io.x[0].shape().elements()),
                      options_.learning_rate,
                      options_.beta1,
                      options_.beta2,
                      options_.epsilon,
                      options_.clip};
  recorder.dispatch_flat("adam", (push.count + 3) / 4,
                         {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.x[3].slice, io.x[4].slice}, push);
}

void Adam::record_backward(Recorder&, const Backward&) const {}

void adam(Graph& graph, const std::string& group, const AdamOptions& options) {
  const Value parameters = graph.group(group);
  const std::string state = "adam/" + group;
  const Value m = graph.state(state, state + "/m", parameters.spec());
  const Value v = graph.state(state, state + "/v", parameters.spec());
  const Value correction = graph.state(state, state + "/correction", row_major({2}));
  graph.update(std::make_shared<Adam>(options), {parameters, graph.gradient(group), m, v, correction});
}

}  // namespace vkopple
