#include "models/learned_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "graph/ops/binary.h"
#include "graph/ops/concat.h"
#include "graph/ops/gelu.h"
#include "graph/ops/pixel_condition.h"
#include "graph/ops/relayout.h"
#include "graph/ops/slice.h"

namespace vkopple {
namespace {

constexpr std::array<int64_t, 3> kLocationWidths{16, 16, 3};
constexpr std::array<int64_t, 4> kPixelWidths{64, 64, 32, 4};

/// How far the pixels of some images go: (n·S, 3, H, W), row-major. The network's fourth number is that of the
/// homogeneous 1, which stays.
Value pixel_steps(LayerFactory& layers, const std::string& name, Value numbers, Value points) {
  Value x = pixel_condition(numbers, points);
  for (size_t i = 0; i < kPixelWidths.size(); ++i) {
    x = layers.conv(x, fmt::format("{}.conv{}", name, i + 1), kPixelWidths[i], 1);
    if (i + 1 < kPixelWidths.size()) x = gelu(x);
  }
  return to_row_major(slice(x, 1, 0, 3));
}

/// (B, S, 3, H, W); as many images at once as the device can bind.
Value moved(LayerFactory& layers, const std::string& name, Value numbers, Value points) {
  const Shape image = points.shape();
  const int64_t hypotheses = numbers.shape()[1];
  const uint64_t each = channels4({hypotheses, std::ranges::max(kPixelWidths), image[2], image[3]}).bytes();
  const int64_t most = std::max<int64_t>(1, static_cast<int64_t>(layers.options().max_tensor_bytes / each));
  std::vector<Value> steps;
  for (int64_t first = 0; first < image[0]; first += most) {
    const int64_t count = std::min(most, image[0] - first);
    steps.push_back(
        pixel_steps(layers, name, take_outer(numbers, first, count), take_outer(points, first, count)));
  }
  Graph& graph = layers.graph();
  return add(graph.reshape(concat(steps, 0), row_major({image[0], hypotheses, 3, image[2], image[3]})),
             graph.reshape(points, row_major({image[0], 1, 3, image[2], image[3]})));
}

}  // namespace

Value learned_location(LayerFactory& layers, Value ego, Value location) {
  const Scope scope(layers.graph(), "learned_location");
  Value x = concat({ego, location}, 2);
  for (size_t i = 0; i < kLocationWidths.size(); ++i) {
    x = layers.linear(x, fmt::format("warpnet1.fc{}", i + 1), kLocationWidths[i],
                      Initial::framework(x.shape().back(0)));
    if (i + 1 < kLocationWidths.size()) x = gelu(x);
  }
  return add(x, location);
}

Value learned_pixels(LayerFactory& layers, Value objects, Value still, Value points) {
  const Scope scope(layers.graph(), "learned_pixels");
  return concat({moved(layers, "warpnet2", objects, points), moved(layers, "warpnet2_bground", still, points)},
                1);
}

}  // namespace vkopple
