#include "models/blocks.h"

#include "graph/ops/binary.h"
#include "graph/ops/crop.h"
#include "graph/ops/leaky_relu.h"

namespace vkopple {
namespace {

/// ⌊extra/2⌋ rows off the top and columns off the left, the rest off the other side.
Value crop_to(Value x, const Shape& size) {
  const int64_t extra_rows = x.shape()[2] - size[2];
  const int64_t extra_columns = x.shape()[3] - size[3];
  if (extra_rows == 0 && extra_columns == 0) return x;
  return crop(x, extra_rows / 2, extra_columns / 2, size[2], size[3]);
}

}  // namespace

Value in_conv(LayerFactory& layers, Value x, int64_t channels) {
  const Scope scope(layers.graph(), "inc");
  return leaky_relu(layers.conv(x, "inc.conv.0", channels, 3), kSlope);
}

Value down(LayerFactory& layers, Value x, const std::string& name, int64_t channels, const Norm& norm) {
  const Scope scope(layers.graph(), name);
  const Value mid = norm(layers.conv(x, name + ".conv.0", x.shape()[1], 3), name + ".conv.2");
  return norm(layers.conv(add(mid, x), name + ".down.0", channels, 3, 2), name + ".down.2");
}

Value up(LayerFactory& layers, Value x, Shape level, Value skip, const std::string& name, int64_t channels,
         const Norm& norm, const UpOptions& options) {
  const Scope scope(layers.graph(), name);
  const Value u =
      crop_to(norm(layers.conv_transpose(x, name + ".up.0", channels, options.kernel), name + ".up.2"), level);
  const Value mixed = skip ? layers.conv_with_skip(skip, u, name + ".conv.0", channels, options.inner)
                           : layers.conv(u, name + ".conv.0", channels, 3);
  const Value out = norm(mixed, name + ".conv.2");
  return options.residual ? add(out, u) : out;
}

}  // namespace vkopple
