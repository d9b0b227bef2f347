#include "models/depth_net.h"

#include <fmt/format.h>

#include <array>

#include "graph/ops/relayout.h"
#include "graph/ops/sigmoid.h"
#include "models/blocks.h"

namespace vkopple {
namespace {

constexpr double kEpsilon = 0.01;
constexpr size_t kLevels = 6;

}  // namespace

Value depth_net(LayerFactory& layers, const ModelConfig& config, Value images) {
  const Scope scope(layers.graph(), "depth");
  const int64_t w = config.depth_width;
  const std::array<int64_t, kLevels + 1> channels{w, 2 * w, 4 * w, 8 * w, 16 * w, 16 * w, 16 * w};
  const Norm norm = [&](Value x, const std::string& name) {
    return layers.act_batch_norm(x, name, kEpsilon, 1);
  };
  const Norm none = [&](Value x, const std::string&) { return layers.act(x); };

  std::vector<Value> skips{in_conv(layers, images, w)};
  for (size_t i = 1; i <= kLevels; ++i)
    skips.push_back(
        down(layers, skips.back(), fmt::format("down{}", i), channels[i], i < kLevels ? norm : none));
  Value x = skips.back();
  for (size_t i = 1; i <= kLevels; ++i)
    x = up(layers, x, skips[kLevels - i].shape(), skips[kLevels - i], fmt::format("up{}", i),
           channels[kLevels - i], i > 1 ? norm : none, {.kernel = 2, .residual = true});
  const Value logit = layers.out_conv(x, "outc.conv", 1, Initial::framework(w * 9));
  return sigmoid(to_row_major(logit), static_cast<float>(config.max_depth));
}

}  // namespace vkopple
