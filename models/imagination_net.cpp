#include "models/imagination_net.h"

#include <fmt/format.h>

#include <array>

#include "graph/ops/binary.h"
#include "graph/ops/relayout.h"
#include "models/blocks.h"

namespace vkopple {
namespace {

constexpr double kEpsilon = 0.01;
constexpr size_t kLevels = 6;
constexpr size_t kSkips = 3;  ///< Ups that see the encoder

}  // namespace

Value imagination_net(LayerFactory& layers, const ModelConfig& config, Value x, Value condition) {
  const Scope scope(layers.graph(), "imagination");
  const int64_t w = config.imagine_width;
  const std::array<int64_t, kLevels + 1> channels{w, 2 * w, 4 * w, 8 * w, 16 * w, 32 * w, 64 * w};
  const Norm norm = [&](Value v, const std::string&) { return layers.act_layer_norm(v, kEpsilon); };
  const Norm none = [&](Value v, const std::string&) { return layers.act(v); };

  std::vector<Value> skips{in_conv(layers, x, w)};
  for (size_t i = 1; i <= kLevels; ++i)
    skips.push_back(
        down(layers, skips.back(), fmt::format("down{}", i), channels[i], i < kLevels ? norm : none));
  const Shape top = skips.back().shape();
  const Value motion = layers.linear(condition, "linear", top.product(1, 4),
                                     Initial::kaiming_uniform(condition.shape().back(0), 1));
  Value y = add(skips.back(), to_channels4(layers.graph().reshape(motion, row_major(top))));
  for (size_t i = 1; i <= kLevels; ++i)
    y = up(layers, y, skips[kLevels - i].shape(), i <= kSkips ? skips[kLevels - i] : Value{},
           fmt::format("up{}", i), channels[kLevels - i], norm, {});
  return layers.out_conv(y, "outc.conv", 5, Initial::framework(w * 9));
}

}  // namespace vkopple
