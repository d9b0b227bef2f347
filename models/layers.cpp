#include "models/layers.h"

#include <cmath>

#include "graph/ops/add_repeated.h"
#include "graph/ops/batch_norm.h"
#include "graph/ops/binary.h"
#include "graph/ops/concat.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/conv_transpose2d.h"
#include "graph/ops/dropout.h"
#include "graph/ops/layer_norm.h"
#include "graph/ops/leaky_relu.h"
#include "graph/ops/linear.h"
#include "graph/ops/slice.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

/// Streams of one network's dropouts never meet another's.
uint32_t network_stream(const std::string& group, uint32_t site) {
  uint32_t h = 2166136261U;
  for (char c : group) h = (h ^ static_cast<unsigned char>(c)) * 16777619U;
  return h + site;
}

}  // namespace

Value LayerFactory::parameter(const std::string& name, const Shape& shape, const Initial& initial) {
  const std::string full = options_.prefix + name;
  const auto [entry, added] = by_name_.try_emplace(full);
  if (added) {
    entry->second = graph_->parameter(options_.group, full, shape);
    tensors_.push_back({entry->second, full, initial});
  } else if (entry->second.shape() != shape) {
    throw Error(full + " is used with two shapes: " + entry->second.shape().text() + " and " + shape.text());
  }
  return entry->second;
}

Value LayerFactory::state(const std::string& name, int64_t size, double initial) {
  const std::string full = options_.prefix + name;
  const auto [entry, added] = by_name_.try_emplace(full);
  if (added) {
    entry->second = graph_->state(options_.group + "/averages", full, row_major({size}));
    tensors_.push_back({entry->second, full, Initial::constant(initial)});
  }
  return entry->second;
}

Initial LayerFactory::conv_initial(const Shape& weight) const {
  switch (options_.initial) {
    case ConvInitial::kKaimingUniform:
      return Initial::kaiming_uniform(fan_in(weight), leaky_gain());
    case ConvInitial::kKaimingNormal:
      return Initial::kaiming_normal(fan_in(weight), leaky_gain());
    case ConvInitial::kFramework:
      return Initial::framework(fan_in(weight));
  }
  throw Error("there is no such initial value of convolutions");
}

Value LayerFactory::conv(Value x, const std::string& name, int64_t channels, int64_t kernel, int64_t stride,
                         int64_t dilation, bool bias) {
  const Shape shape{channels, x.shape()[1], kernel, kernel};
  // Only the ASPP's convolutions go without bias; they start with the gain of a plain ReLU (docs/model.md
  // §2.2).
  const Value w =
      parameter(name + ".weight", shape,
                bias ? conv_initial(shape) : Initial::kaiming_normal(fan_in(shape), std::sqrt(2.0)));
  const Value b = bias ? parameter(name + ".bias", {channels}, Initial::framework(fan_in(shape))) : Value{};
  return conv2d(x, w, b, {.stride = stride, .padding = kernel / 2 * dilation, .dilation = dilation});
}

Value LayerFactory::conv_with_skip(Value skip, Value x, const std::string& name, int64_t channels,
                                   int64_t inner) {
  const int64_t skip_channels = skip.shape()[1];
  const Shape shape{channels, skip_channels + x.shape()[1], 3, 3};
  const Value w = parameter(name + ".weight", shape, conv_initial(shape));
  const Value b = parameter(name + ".bias", {channels}, Initial::framework(fan_in(shape)));
  const Shape joined{x.shape()[0], shape[1], x.shape()[2], x.shape()[3]};
  if (inner == 0 && channels4(joined).bytes() <= options_.max_tensor_bytes)
    return conv2d(concat({skip, x}, 1), w, b, {.padding = 1});
  // W · [skip, x] = W_s · skip + W_x · x. Where the skip is the same for every slot, its part is computed once;
  // else the device can't bind both as one.
  Value& from_skip = skip_parts_[{name, skip.id()}];
  if (!from_skip) from_skip = conv2d(skip, slice(w, 1, 0, skip_channels), Value{}, {.padding = 1});
  const Value from_x = conv2d(x, slice(w, 1, skip_channels, x.shape()[1]), b, {.padding = 1});
  return add_repeated(from_x, from_skip, inner > 0 ? inner : x.shape()[0]);
}

Value LayerFactory::conv_transpose(Value x, const std::string& name, int64_t channels, int64_t kernel) {
  const Shape shape{x.shape()[1], channels, kernel, kernel};
  const Value w = parameter(name + ".weight", shape, conv_initial(shape));
  const Value b = parameter(name + ".bias", {channels}, Initial::framework(fan_in(shape)));
  return conv_transpose2d(x, w, b);
}

Value LayerFactory::out_conv(Value x, const std::string& name, int64_t channels, const Initial& initial) {
  const Shape shape{channels, x.shape()[1], 3, 3};
  const Value w = parameter(name + ".weight", shape, initial);
  const Value b = parameter(name + ".bias", {channels}, Initial::framework(fan_in(shape)));
  return conv2d(x, w, b, {.padding = 1});
}

Value LayerFactory::linear(Value x, const std::string& name, int64_t outputs, const Initial& weight,
                           const std::optional<Initial>& bias) {
  const int64_t inputs = x.shape().back(0);
  const Value w = parameter(name + ".weight", {outputs, inputs}, weight);
  const Value b = parameter(name + ".bias", {outputs}, bias.value_or(Initial::framework(inputs)));
  return vkopple::linear(x, w, b);
}

Value LayerFactory::batch_norm_with(Value x, const std::string& name, double epsilon, int64_t groups,
                                    double slope, double dropout, double bias) {
  const int64_t channels = x.shape()[1];
  const Value gamma = parameter(name + ".weight", {channels}, Initial::constant(1));
  const Value beta = parameter(name + ".bias", {channels}, Initial::constant(bias));
  const Value mean = state(name + ".running_mean", channels, 0);
  const Value variance = state(name + ".running_var", channels, 1);
  BatchNormOptions options{};
  options.eps = static_cast<float>(epsilon);
  options.groups = groups;
  options.training = options_.training;
  options.slope = static_cast<float>(slope);
  options.dropout = static_cast<float>(dropout);
  options.peers = options_.statistics_peers;
  options.stream = dropout > 0 ? network_stream(options_.group, next_stream()) : 0;
  return vkopple::batch_norm(x, gamma, beta, mean, variance, dropout > 0 ? options_.random : Value{}, options);
}

Value LayerFactory::act_batch_norm(Value x, const std::string& name, double epsilon, int64_t groups) {
  return batch_norm_with(x, name, epsilon, groups, static_cast<double>(kSlope), active_dropout(), 0);
}

Value LayerFactory::batch_norm(Value x, const std::string& name, double epsilon, int64_t groups, double bias) {
  return batch_norm_with(x, name, epsilon, groups, 1, 0, bias);
}

Value LayerFactory::act_layer_norm(Value x, double epsilon) {
  LayerNormOptions options{};
  options.eps = static_cast<float>(epsilon);
  options.slope = kSlope;
  options.dropout = static_cast<float>(active_dropout());
  options.stream = options.dropout > 0 ? network_stream(options_.group, next_stream()) : 0;
  return layer_norm(x, options.dropout > 0 ? options_.random : Value{}, options);
}

Value LayerFactory::act(Value x) { return dropout(leaky_relu(x, kSlope)); }

Value LayerFactory::dropout(Value x) {
  const double rate = active_dropout();
  if (rate <= 0) return x;
  return vkopple::dropout(x, options_.random, static_cast<float>(rate),
                          network_stream(options_.group, next_stream()));
}

}  // namespace vkopple
