#pragma once

#include "graph/graph.h"

namespace vkopple {

/// How far the warped image counts against the imagined one: 0.99 · clip(total, 0, 1), or 0 without warping
/// (the ablation). Any row-major shape. The gradient passes where 0 <= total <= 1.
class WarpShare : public Op {
 public:
  explicit WarpShare(bool warp) : warp_(warp) {}
  std::string_view name() const override { return "warp_share"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t) const override { return warp_; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  bool warp_;
};

Value warp_share(Value total, bool warp);

}  // namespace vkopple
