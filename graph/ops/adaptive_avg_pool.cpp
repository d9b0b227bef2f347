#include "graph/ops/adaptive_avg_pool.h"

namespace vkopple {

Value adaptive_avg_pool(Value x, int64_t height, int64_t width) {
  return x.graph().apply1(std::make_shared<AdaptiveAvgPool>(height, width), {x});
}

}  // namespace vkopple
