#pragma once

#include "graph/graph.h"

namespace vkopple {

/// Points of the pixels in the camera's frame (x right, y forward, z up): (B, 1, H, W) distances from the
/// camera to (B, 3, H, W). P = D · (i/f, 1, −j/f) / √(1 + (i/f)² + (j/f)²) with i, j counted from the image's
/// centre.
class BackProject : public Op {
 public:
  /// fov: vertical field of view in radians, below π.
  explicit BackProject(float fov) : fov_(fov) {}
  std::string_view name() const override { return "back_project"; }
  float fov() const { return fov_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  float fov_;
};

Value back_project(Value depth, float fov);

}  // namespace vkopple
