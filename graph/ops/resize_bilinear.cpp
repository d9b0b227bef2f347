#include "graph/ops/resize_bilinear.h"

namespace vkopple {

Value resize_bilinear(Value x, int64_t height, int64_t width) {
  return x.graph().apply1(std::make_shared<ResizeBilinear>(height, width), {x});
}

}  // namespace vkopple
