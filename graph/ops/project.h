#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Points (B, S, 3, H, W) in the camera's frame to the image: u, v in pixels from its centre (v downward) and
/// the signed distance d, as (B, S, 3, H, W). (u, v) = f · (x, −z) / (|y| + 1e-5), d = ‖P‖ · sign(y + 1e-5);
/// the slopes of |y| and ‖P‖ at 0 count as 0.
class Project : public Op {
 public:
  /// fov: vertical field of view in radians, below π.
  explicit Project(float fov) : fov_(fov) {}
  std::string_view name() const override { return "project"; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  float fov_;
};

Value project(Value points, float fov);

}  // namespace vkopple
