#pragma once

#include "graph/graph.h"
#include "graph/kernels/resampling.h"

namespace vkopple {

/// Means over a grid of height × width bins of (N, C, H, W) in NC4HW4. Bin i spans rows ⌊i H / height⌋ up to,
/// not including, ⌈(i + 1) H / height⌉; columns likewise. Bins overlap where the sizes do not divide.
class AdaptiveAvgPool : public Resampling {
 public:
  AdaptiveAvgPool(int64_t height, int64_t width) : Resampling(height, width) {}
  std::string_view name() const override { return "adaptive_avg_pool"; }
};

Value adaptive_avg_pool(Value x, int64_t height, int64_t width);

}  // namespace vkopple
