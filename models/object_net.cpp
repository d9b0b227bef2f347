#include "models/object_net.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "graph/ops/adaptive_avg_pool.h"
#include "graph/ops/concat.h"
#include "graph/ops/leaky_relu.h"
#include "graph/ops/lstm.h"
#include "graph/ops/permute.h"
#include "graph/ops/relayout.h"
#include "graph/ops/resize_bilinear.h"
#include "graph/ops/slice.h"
#include "models/blocks.h"
#include "models/slot_counters.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr double kEncoderEpsilon = 1e-6;
constexpr double kDecoderEpsilon = 0.01;
constexpr double kAsppEpsilon = 1e-5;
constexpr double kAsppBias = 1e-4;
constexpr size_t kLevels = 7;
constexpr size_t kAsppLevel = 3;  ///< the ASPP sits between this Down and the next

std::array<int64_t, kLevels + 1> channels_of(const ModelConfig& config) {
  const int64_t w = config.object_width;
  return {w, w, w, 2 * w, 2 * w, 4 * w, 4 * w, 4 * w};
}

Value aspp(LayerFactory& layers, Value x, int64_t frames) {
  const Scope scope(layers.graph(), "aspp");
  const int64_t channels = x.shape()[1];
  const auto norm = [&](Value v, const std::string& name) {
    return layers.batch_norm(v, name, kAsppEpsilon, frames, kAsppBias);
  };
  std::vector<Value> branches;
  const std::array<int64_t, 4> dilations{1, 6, 12, 18};
  for (size_t i = 0; i < dilations.size(); ++i) {
    const std::string name = fmt::format("assp.aspp{}", i + 1);
    const Value y = layers.conv(x, name + ".0", channels, i == 0 ? 1 : 3, 1, dilations[i], false);
    branches.push_back(norm(leaky_relu(y, kSlope), name + ".2"));
  }
  const Value pooled = norm(
      layers.conv(adaptive_avg_pool(x, 4, 4), "assp.avg_pool.1", channels, 1, 1, 1, false), "assp.avg_pool.2");
  branches.push_back(resize_bilinear(leaky_relu(pooled, kSlope), x.shape()[2], x.shape()[3]));
  const Value mixed = layers.conv(concat(branches, 1), "assp.conv1", channels, 1, 1, 1, false);
  return layers.act(norm(mixed, "assp.bn1"));
}

std::vector<Value> encode(LayerFactory& layers, const ModelConfig& config, Value images, int64_t frames) {
  const auto channels = channels_of(config);
  const Norm norm = [&](Value x, const std::string& name) {
    return layers.act_batch_norm(x, name, kEncoderEpsilon, frames);
  };
  std::vector<Value> skips{in_conv(layers, images, channels[0])};
  for (size_t i = 1; i <= kLevels; ++i) {
    const Value x = i == kAsppLevel + 1 ? aspp(layers, skips.back(), frames) : skips.back();
    skips.push_back(down(layers, x, fmt::format("down{}", i), channels[i], norm));
  }
  return skips;
}

/// (N, C, h, w) → slots' raw numbers (N, K, R).
Value read_slots(LayerFactory& layers, const ModelConfig& config, Value top) {
  const Scope scope(layers.graph(), "slots");
  const int64_t samples = top.shape()[0];
  const int64_t features = top.shape().product(1, 4);
  const int64_t hidden = config.lstm;
  const Value x = layers.graph().reshape(to_row_major(top), row_major({samples, features}));
  const Shape ih{4 * hidden, features};
  const Shape hh{4 * hidden, hidden};
  const SlotCounters start = slot_counters(config, features);
  const Value w_ih = layers.parameter("rnn.weight_ih_l0", ih, start.weight_ih);
  const Value w_hh = layers.parameter("rnn.weight_hh_l0", hh, start.weight_hh);
  const Value b_ih = layers.parameter("rnn.bias_ih_l0", {4 * hidden}, start.bias_ih);
  const Value b_hh = layers.parameter("rnn.bias_hh_l0", {4 * hidden}, start.bias_hh);
  const Value h = leaky_relu(lstm(x, w_ih, w_hh, b_ih, b_hh, config.slots), kSlope);
  const int64_t numbers = 3 + config.orientation_numbers() + config.code;
  return layers.linear(h, "lin.1", numbers, start.head_weight, start.head_bias);
}

/// Mask logits (K'·B, 1, H, W), row-major, of codes (K', B, code); samples are ordered slot, image.
Value decode_masks(LayerFactory& layers, const ModelConfig& config, Value codes,
                   const std::vector<Value>& skips) {
  Graph& graph = layers.graph();
  const auto channels = channels_of(config);
  const Shape top = skips.back().shape();
  const int64_t slots = codes.shape()[0];
  const int64_t batch = codes.shape()[1];
  const int64_t samples = slots * batch;
  const int64_t groups = config.mask_statistics == MaskStatistics::kApart ? slots : 1;
  const Norm norm = [&](Value x, const std::string& name) {
    return layers.act_batch_norm(x, name, kDecoderEpsilon, groups);
  };
  const Value flat = graph.reshape(codes, row_major({samples, config.code}));
  const Value seed = leaky_relu(
      layers.linear(flat, "up1_att_lin.0", top.product(1, 4), Initial::framework(config.code)), kSlope);
  Value x = to_channels4(graph.reshape(seed, row_major({samples, top[1], top[2], top[3]})));
  for (size_t i = 0; i < kLevels; ++i)
    x = up(layers, x, skips[kLevels - 1 - i].shape(), skips[kLevels - 1 - i], fmt::format("up{}_att", i),
           channels[kLevels - 1 - i], norm, {.inner = batch});
  const int64_t w = config.object_width;
  return to_row_major(layers.out_conv(x, "outc_att.conv", 1, Initial::kaiming_normal(w * 9, 1)));
}

/// Whether the device binds the network's largest tensor for so many samples.
bool fits(const LayerFactory& layers, const ModelConfig& config, int64_t samples) {
  return channels4({samples, config.object_width, config.height, config.width}).bytes() <=
         layers.options().max_tensor_bytes;
}

/// One frame's mask logits (K, B, H, W) from its raw numbers (B, K, R) and skips: all slots in one call where
/// they fit, else one after the other. Throws Error where they don't and need statistics together.
Value mask_logits(LayerFactory& layers, const ModelConfig& config, Value raw, const std::vector<Value>& skips) {
  const Scope scope(layers.graph(), "masks");
  const int64_t batch = raw.shape()[0];
  const Value codes = permute(slice(raw, 2, 3 + config.orientation_numbers(), config.code), {1, 0, 2});
  Value logits;
  if (fits(layers, config, config.slots * batch)) {
    logits = decode_masks(layers, config, codes, skips);
  } else {
    if (layers.options().training && config.mask_statistics == MaskStatistics::kTogether) {
      throw Error(
          fmt::format("this device can't bind the masks of {} slots of {} images at once, as "
                      "mask_statistics \"together\" needs; give a smaller --batch",
                      config.slots, batch));
    }
    std::vector<Value> slots;
    for (int64_t k = 0; k < config.slots; ++k)
      slots.push_back(decode_masks(layers, config, take_outer(codes, k, 1), skips));
    logits = concat(slots, 0);
  }
  return layers.graph().reshape(logits, row_major({config.slots, batch, config.height, config.width}));
}

/// Frames encoded in one call, taken apart again.
struct EncodedFrame {
  std::vector<Value> skips;
  Value raw;  ///< (B, K, R)
};

std::vector<EncodedFrame> encode_frames(LayerFactory& layers, const ModelConfig& config, Value images,
                                        int64_t frames) {
  const auto skips = encode(layers, config, images, frames);
  const Value raw = read_slots(layers, config, skips.back());
  const int64_t batch = images.shape()[0] / frames;
  std::vector<EncodedFrame> apart(static_cast<size_t>(frames));
  for (int64_t f = 0; f < frames; ++f) {
    EncodedFrame& frame = apart[static_cast<size_t>(f)];
    for (const Value& skip : skips) frame.skips.push_back(take_outer(skip, f * batch, batch));
    frame.raw = take_outer(raw, f * batch, batch);
  }
  return apart;
}

}  // namespace

std::vector<ObjectOutputs> object_net(LayerFactory& layers, const ModelConfig& config, Value images,
                                      const std::vector<bool>& masks) {
  const Scope scope(layers.graph(), "object");
  const auto frames = static_cast<int64_t>(masks.size());
  const int64_t batch = images.shape()[0] / frames;
  std::vector<EncodedFrame> encoded;
  if (fits(layers, config, frames * batch)) {
    encoded = encode_frames(layers, config, images, frames);
  } else {
    for (int64_t f = 0; f < frames; ++f)
      encoded.push_back(encode_frames(layers, config, take_outer(images, f * batch, batch), 1).front());
  }
  std::vector<ObjectOutputs> outputs;
  for (size_t f = 0; f < masks.size(); ++f) {
    const EncodedFrame& frame = encoded[f];
    outputs.push_back(
        {.raw = frame.raw,
         .mask_logits = masks[f] ? mask_logits(layers, config, frame.raw, frame.skips) : Value{}});
  }
  return outputs;
}

}  // namespace vkopple
