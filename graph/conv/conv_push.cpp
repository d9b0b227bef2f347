#include "graph/conv/conv_push.h"

#include <algorithm>

namespace vkopple {

Channels channels_of(const ConvShape& shape, ConvDirection direction) {
  if (direction == ConvDirection::kForward) return {shape.ci, shape.co};
  return {shape.co, shape.ci};
}

int64_t phase_pixels(const ProductPush& push) {
  const int64_t rows = (push.out_h + push.phases - 1) / push.phases;
  const int64_t columns = (push.out_w + push.phases - 1) / push.phases;
  return push.n * rows * columns;
}

Groups phase_groups(int64_t tiles, int64_t phases, const Caps& caps) {
  const int64_t x = std::min<int64_t>(tiles, caps.max_groups[0]);
  return {static_cast<uint32_t>(x), static_cast<uint32_t>((tiles + x - 1) / x), static_cast<uint32_t>(phases)};
}

}  // namespace vkopple
