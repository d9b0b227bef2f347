#include "graph/ops/layer_norm.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/checks/check_random.h"

namespace vkopple {
namespace {

HostTensors layer_norm_reference(const HostTensors& x, const TensorSpec& spec, const LayerNormOptions& o) {
  HostTensor y = x[0];
  for (double& e : y.values) e = e > 0 ? e : static_cast<double>(o.slope) * e;
  const auto count = static_cast<size_t>(y.shape.product(1, 4));
  for (size_t begin = 0; begin < y.values.size(); begin += count) {
    const std::span<double> sample(&y.values[begin], count);
    double mean = 0;
    for (double v : sample) mean += v / static_cast<double>(count);
    double variance = 0;
    for (double v : sample) variance += (v - mean) * (v - mean) / static_cast<double>(count);
    for (double& v : sample) v = (v - mean) / std::sqrt(variance + static_cast<double>(o.eps));
  }
  if (o.dropout > 0) apply_dropout(y, spec, x[1], o.stream, o.dropout);
  return {y};
}

CheckCase layer_norm_case(const Shape& shape, const LayerNormOptions& o, double offset = 0) {
  const TensorSpec spec = channels4(shape);
  CheckCase check{
      .label = fmt::format("{} slope {} dropout {} offset {}", shape.text(), o.slope, o.dropout, offset),
      .op = std::make_shared<LayerNorm>(o),
      .inputs = {spec},
      .reference = [=](const HostTensors& x) { return layer_norm_reference(x, spec, o); },
      .prepare =
          [=](HostTensors& x) {
            for (double& v : x[0].values) v += std::copysign(0.01, v) + offset;
            if (x.size() > 1) set_random(x[1], 5, 600);
          }};
  if (o.dropout > 0) check.inputs.push_back(unsigned_ints({2}));
  return check;
}

}  // namespace

void check_layer_norm(CheckList& list) {
  list.push_back(layer_norm_case({1, 1, 1, 2}, {}));
  list.push_back(layer_norm_case({3, 7, 1, 1}, {.slope = 0.1F}));
  list.push_back(layer_norm_case({2, 13, 2, 2}, {.eps = 1e-4F, .slope = 0.1F, .dropout = 0.2F, .stream = 4}));
  list.push_back(layer_norm_case({5, 3, 5, 7}, {.slope = 0.1F, .dropout = 0.05F}));
  list.push_back(layer_norm_case({1, 8, 16, 17}, {.slope = 0.1F}));
  list.push_back(layer_norm_case({2, 6, 6, 7}, {.slope = 0.1F, .dropout = 0.2F}));
  list.push_back(layer_norm_case({2, 2, 67, 31}, {.eps = 1e-5F}, 200));
}

}  // namespace vkopple
