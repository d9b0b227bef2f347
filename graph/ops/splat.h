#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Forward-splats every pixel of image (B, 3, H, W) to where each of its S hypotheses projects: uvd (B, S, 3,
/// H, W) from Project, weights (B, S, H, W), all row-major. Gives the warped image (B, 3, H, W), the warped
/// depth (B, 1, H, W) and the total weight (B, 1, H, W). Nothing flows back into the image.
///
/// With a = weight · bilinear weight of a target pixel, over the points with d > 1e-5: total = Σ a, and the
/// mean of colour and of d with weights a · exp(−beta · d), whose sum has 1e-22 added. What falls outside the
/// image is lost. The bilinear weights' floor counts as constant, and their slope on a whole pixel as 0.
///
/// No sum depends on the order of threads: points are counted into the cells between pixel centres, each cell's
/// list is sorted, and every pixel gathers from its four cells. Points that are not finite are lost like those
/// outside.
class Splat : public Op {
 public:
  /// beta: how fast a point's weight falls with its distance, in 1 / scene unit.
  explicit Splat(float beta) : beta_(beta) {}
  std::string_view name() const override { return "splat"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  bool differentiable(size_t input) const override { return input != 0; }
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  float beta_;
};

/// Image, depth, total.
std::vector<Value> splat(Value image, Value uvd, Value weight, float beta);

}  // namespace vkopple
