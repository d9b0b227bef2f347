#pragma once

#include "graph/graph.h"
#include "graph/kernels/resampling.h"

namespace vkopple {

/// Bilinear resizing of (N, C, H, W) in NC4HW4 to another height and width with aligned corners: row i of the
/// result lies at i (H − 1) / (height − 1) of the input, at 0 where height is 1; columns likewise.
class ResizeBilinear : public Resampling {
 public:
  ResizeBilinear(int64_t height, int64_t width) : Resampling(height, width) {}
  std::string_view name() const override { return "resize_bilinear"; }
};

Value resize_bilinear(Value x, int64_t height, int64_t width);

}  // namespace vkopple
